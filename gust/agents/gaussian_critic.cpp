#include "gust/agents/gaussian_critic.h"

#include <algorithm>
#include <functional>

#include "gust/agents/squashed_actor.h"
#include "gust/nn/initialise.h"

namespace gust {
namespace {

TrainedMlp<float> make_critic(const WcpgOptions& options, const TransitionShape& shape, Rng rng) {
  TrainedMlp<float> critic(off_policy_shape(options, shape.observations + shape.actions + shape.extras, 2),
                           static_cast<std::size_t>(options.batch),
                           {.first = shape.observations, .count = shape.actions}, TrainedMlp<float>::Target::kYes);
  initialise_uniform(critic.mlp(), rng);
  critic.start();
  return critic;
}

ReturnLaw law_of(const Tiles<float>& outputs, std::size_t lane) {
  return return_law(outputs.at(lane, 0), outputs.at(lane, 1));
}

void put(const OutputSlope& slope, double factor, Tiles<float>& into, std::size_t lane) {
  into.at(lane, 0) = static_cast<float>(factor * slope.mean);
  into.at(lane, 1) = static_cast<float>(factor * slope.raw);
}

}  // namespace

GaussianCritic::GaussianCritic(const WcpgOptions& options, const TransitionShape& shape, Rng rng)
    : loss_(options.loss()),
      form_(options.cvar_form()),
      polyak_(static_cast<float>(options.polyak)),
      adam_{.rate = options.critic_rate, .epsilon = options.adam_epsilon},
      critics_{make_critic(options, shape, rng.split("critic 1")), make_critic(options, shape, rng.split("critic 2"))},
      samples_(static_cast<std::size_t>(options.batch)) {
  for (Tiles<float>& at_outputs : at_outputs_) at_outputs = Tiles<float>(samples_.size(), 2);
}

/// c of a lane's level.
double GaussianCritic::coefficient(const Tiles<float>& input, std::size_t lane) const {
  return cvar_coefficient(input.at(lane, input.features() - 1), form_);
}

void GaussianCritic::judge(const Tiles<float>& input, Rng, Judgement judgement) {
  const std::array<const Tiles<float>*, 2> outputs = {&critics_[0].forward(input), &critics_[1].forward(input)};
  for (std::size_t lane = 0; lane < input.lanes(); ++lane) {
    const double c = coefficient(input, lane);
    const double first = law_of(*outputs[0], lane).cvar(c);
    const double second = law_of(*outputs[1], lane).cvar(c);
    const std::size_t lesser = first <= second ? 0 : 1;
    judgement.value[lane] = static_cast<float>(std::min(first, second));
    put(cvar_slope(c, outputs[lesser]->at(lane, 1)), 1.0, at_outputs_[lesser], lane);
    put({}, 0.0, at_outputs_[1 - lesser], lane);
  }
  const Tiles<float>& first = critics_[0].backward_to_input(at_outputs_[0]);
  const Tiles<float>& second = critics_[1].backward_to_input(at_outputs_[1]);
  const std::size_t actions = judgement.at_action.features();
  for (std::size_t tile = 0; tile < input.count(); ++tile)
    std::ranges::transform(first.features(tile, first.features() - actions, actions),
                           second.features(tile, second.features() - actions, actions),
                           judgement.at_action.tile(tile).begin(), std::plus<>());
}

/// What the critics shall learn from: rewards, and the law of what follows.
void GaussianCritic::set_targets(const UpdateBatch& update) {
  const Tiles<float>& input = update.batch.next_acted;
  const Tiles<float>& first = critics_[0].forward_target(input);
  const Tiles<float>& second = critics_[1].forward_target(input);
  for (std::size_t lane = 0; lane < samples_.size(); ++lane) {
    const double c = coefficient(input, lane);
    const ReturnLaw one = law_of(first, lane);
    const ReturnLaw other = law_of(second, lane);
    samples_[lane] = {.reward = update.batch.reward[lane],
                      .follows = update.batch.alive[lane],
                      .entropy_cost = update.temperature * update.next_log_density[lane],
                      .next = one.cvar(c) <= other.cvar(c) ? one : other};
  }
}

double GaussianCritic::update(const UpdateBatch& update) {
  set_targets(update);
  const double share = 1.0 / static_cast<double>(samples_.size());
  double loss = 0.0;
  for (std::size_t critic = 0; critic < critics_.size(); ++critic) {
    const Tiles<float>& outputs = critics_[critic].forward(update.batch.taken);
    for (std::size_t lane = 0; lane < samples_.size(); ++lane) {
      const ReturnLaw law = law_of(outputs, lane);
      const ReturnTarget target = return_target(loss_, samples_[lane], law.mean);
      loss += share * return_loss(loss_, law, target);
      put(return_loss_slope(loss_, law, outputs.at(lane, 1), target), share, at_outputs_[critic], lane);
    }
    critics_[critic].step(adam_, at_outputs_[critic], polyak_);
  }
  return loss;
}

std::vector<ReturnLaw> GaussianCritic::laws(std::size_t critic, const Tiles<float>& input) {
  const Tiles<float>& outputs = critics_[critic].forward(input);
  std::vector<ReturnLaw> laws;
  for (std::size_t lane = 0; lane < input.lanes(); ++lane) laws.push_back(law_of(outputs, lane));
  return laws;
}

bool GaussianCritic::finite() const { return critics_[0].finite() && critics_[1].finite(); }

void GaussianCritic::save(Saver& saver) const {
  for (const TrainedMlp<float>& critic : critics_) TrainedMlp<float>::archive(saver, critic);
}

void GaussianCritic::load(Loader& loader) {
  for (TrainedMlp<float>& critic : critics_) TrainedMlp<float>::archive(loader, critic);
}

}  // namespace gust
