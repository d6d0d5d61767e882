#include "gust/agents/off_policy_learner.h"

namespace gust {

OffPolicyLearner::OffPolicyLearner(const OffPolicyOptions& options, const TransitionShape& shape, const ActionBox& box,
                                   const MakeCritic& make_critic, Rng rng)
    : critics_first_(options.sac_order == "original"),
      rng_(rng),
      actor_(options, shape.observations + shape.extras, box, rng.split("actor")),
      temperature_(options, shape.actions),
      critic_(make_critic(options, shape, rng.split("critic"))),
      rows_(static_cast<std::size_t>(options.batch)),
      batch_(shape, rows_.size()),
      value_(rows_.size()),
      at_action_(rows_.size(), shape.actions) {}

void OffPolicyLearner::update(const Replay& replay) {
  const Rng rng = rng_.split("updates").split(static_cast<std::uint64_t>(updates_));
  replay.sample(rng.split("replay"), rows_);
  batch_.gather(replay, rows_);
  if (prepare_) prepare_(batch_, rng.split("prepare"));
  if (critics_first_) {
    teach_critics(rng);
    actor_.propose(batch_.observation, rng.split("action"), batch_.shape.observations, batch_.acted);
    move_temperature();
    improve_actor(rng);
  } else {
    actor_.propose(batch_.observation, rng.split("action"), batch_.shape.observations, batch_.acted);
    improve_actor(rng);
    move_temperature();
    teach_critics(rng);
  }
  ++updates_;
}

/// One step of the actor, whose actions were proposed, along the gradient of mean(temperature log pi - value).
void OffPolicyLearner::improve_actor(Rng rng) {
  critic_->judge(batch_.acted, rng.split("judge"), {value_, at_action_});
  actor_.improve(at_action_, temperature_.value());
}

/// One step of the critics. What follows a transition is what the present actor would do.
void OffPolicyLearner::teach_critics(Rng rng) {
  actor_.propose(batch_.next, rng.split("next"), batch_.shape.observations, batch_.next_acted);
  critic_->update({batch_, actor_.log_density().first(batch_.lanes()), temperature_.value(), rng.split("learn")});
}

void OffPolicyLearner::save(Saver& saver) const {
  archive(saver, *this);
  critic_->save(saver);
}

void OffPolicyLearner::load(Loader& loader) {
  archive(loader, *this);
  critic_->load(loader);
}

}  // namespace gust
