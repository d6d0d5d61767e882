#include "gust/agents/twin_critic.h"

#include <algorithm>

#include "gust/agents/squashed_actor.h"
#include "gust/nn/initialise.h"

namespace gust {
namespace {

TrainedMlp<float> make_critic(const OffPolicyOptions& options, const TransitionShape& shape, Rng rng) {
  TrainedMlp<float> critic(off_policy_shape(options, shape.observations + shape.actions + shape.extras, 1),
                           static_cast<std::size_t>(options.batch),
                           {.first = shape.observations, .count = shape.actions}, TrainedMlp<float>::Target::kYes);
  initialise_uniform(critic.mlp(), rng);
  critic.start();
  return critic;
}

}  // namespace

TwinCritic::TwinCritic(const OffPolicyOptions& options, const TransitionShape& shape, Rng rng)
    : discount_(options.discount),
      polyak_(static_cast<float>(options.polyak)),
      adam_{.rate = options.critic_rate, .epsilon = options.adam_epsilon},
      critics_{make_critic(options, shape, rng.split("critic 1")), make_critic(options, shape, rng.split("critic 2"))} {
  for (Tiles<float>& at_value : at_value_) at_value = Tiles<float>(static_cast<std::size_t>(options.batch), 1);
  target_.resize(static_cast<std::size_t>(options.batch));
}

void TwinCritic::judge(const Tiles<float>& input, Rng, Judgement judgement) {
  const std::array<const Tiles<float>*, 2> value = {&critics_[0].forward(input), &critics_[1].forward(input)};
  for (std::size_t lane = 0; lane < input.lanes(); ++lane) {
    const float first = value[0]->at(lane, 0);
    const float second = value[1]->at(lane, 0);
    judgement.value[lane] = std::min(first, second);
    at_value_[0].at(lane, 0) = first <= second ? 1.0f : 0.0f;
    at_value_[1].at(lane, 0) = first <= second ? 0.0f : 1.0f;
  }
  const Tiles<float>& first = critics_[0].backward_to_input(at_value_[0]);
  const Tiles<float>& second = critics_[1].backward_to_input(at_value_[1]);
  const std::size_t actions = judgement.at_action.features();
  for (std::size_t tile = 0; tile < input.count(); ++tile)
    std::ranges::transform(first.features(tile, first.features() - actions, actions),
                           second.features(tile, second.features() - actions, actions),
                           judgement.at_action.tile(tile).begin(), std::plus<>());
}

/// The targets of a minibatch; in double, for they may be a hundred times the rewards.
void TwinCritic::set_targets(const UpdateBatch& update) {
  const Tiles<float>& first = critics_[0].forward_target(update.batch.next_acted);
  const Tiles<float>& second = critics_[1].forward_target(update.batch.next_acted);
  for (std::size_t lane = 0; lane < target_.size(); ++lane) {
    const double follows =
        std::min(first.at(lane, 0), second.at(lane, 0)) - update.temperature * update.next_log_density[lane];
    target_[lane] = static_cast<float>(update.batch.reward[lane] + discount_ * update.batch.alive[lane] * follows);
  }
}

double TwinCritic::update(const UpdateBatch& update) {
  set_targets(update);
  const auto lanes = static_cast<float>(target_.size());
  double loss = 0.0;
  for (std::size_t critic = 0; critic < critics_.size(); ++critic) {
    const Tiles<float>& value = critics_[critic].forward(update.batch.taken);
    for (std::size_t lane = 0; lane < target_.size(); ++lane) {
      const float error = value.at(lane, 0) - target_[lane];
      at_value_[critic].at(lane, 0) = 2.0f * error / lanes;
      loss += static_cast<double>(error) * error / lanes;
    }
    critics_[critic].step(adam_, at_value_[critic], polyak_);
  }
  return loss;
}

bool TwinCritic::finite() const { return critics_[0].finite() && critics_[1].finite(); }

void TwinCritic::save(Saver& saver) const {
  for (const TrainedMlp<float>& critic : critics_) TrainedMlp<float>::archive(saver, critic);
}

void TwinCritic::load(Loader& loader) {
  for (TrainedMlp<float>& critic : critics_) TrainedMlp<float>::archive(loader, critic);
}

}  // namespace gust
