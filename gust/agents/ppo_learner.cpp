#include "gust/agents/ppo_learner.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gust/nn/gaussian.h"
#include "gust/nn/initialise.h"

namespace gust {
namespace {

/// Lanes that a workspace must hold: a minibatch, a step of all environments.
std::size_t lanes_of(const PpoOptions& options) {
  return static_cast<std::size_t>(std::max(options.minibatch, options.environments));
}

void initialise(Mlp<float>& mlp, const PpoOptions& options, double output_gain, Rng rng) {
  options.init == "orthogonal" ? initialise_orthogonal(mlp, {.output = output_gain}, rng)
                               : initialise_uniform(mlp, rng);
}

bool all_finite(std::span<const float> values) {
  return std::ranges::all_of(values, [](float value) { return std::isfinite(value); });
}

/// One number of each of some samples.
template <class From>
void pick(const From& from, std::span<const std::uint32_t> samples, std::span<float> to) {
  for (std::size_t i = 0; i < samples.size(); ++i) to[i] = static_cast<float>(from[samples[i]]);
}

/// `width` numbers of each of some samples.
void pick_rows(std::span<const float> from, std::span<const std::uint32_t> samples, std::size_t width,
               std::span<float> to) {
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t j = 0; j < width; ++j) to[i * width + j] = from[samples[i] * width + j];
}

}  // namespace

void shuffle(std::span<std::uint32_t> order, Rng rng) {
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[rng.below(i, i)]);
}

MlpShape ppo_shape(const PpoOptions& options, std::size_t inputs, std::size_t outputs) {
  MlpShape shape;
  shape.sizes.assign(static_cast<std::size_t>(options.layers), static_cast<std::size_t>(options.hidden));
  shape.sizes.insert(shape.sizes.begin(), inputs);
  shape.sizes.push_back(outputs);
  shape.activation = options.activation == "tanh"   ? Activation::kTanh
                     : options.activation == "relu" ? Activation::kRelu
                                                    : Activation::kLeakyRelu;
  return shape;
}

PpoLearner::PpoLearner(const PpoOptions& options, std::size_t observations, std::size_t actions, Rng rng)
    : options_(options),
      rng_(rng),
      actor_(ppo_shape(options, observations, actions), lanes_of(options)),
      critic_(ppo_shape(options, observations, 1), lanes_of(options)),
      log_std_(actions, static_cast<float>(options.log_std)),
      log_std_gradient_(actions),
      log_std_adam_(actions) {
  const auto batch = static_cast<std::size_t>(options.minibatch);
  observation_.resize(batch * observations);
  for (Buffer<float>* buffer : {&action_, &at_mean_}) buffer->resize(batch * actions);
  for (Buffer<float>* buffer :
       {&old_log_density_, &old_value_, &advantage_, &target_, &log_density_, &at_log_density_, &at_value_}) {
    buffer->resize(batch);
  }
  minibatch_advantage_.resize(batch);
  initialise(actor_.mlp, options, 0.01, rng.split("actor"));
  initialise(critic_.mlp, options, 1.0, rng.split("critic"));
}

bool PpoLearner::finite() const {
  return all_finite(actor_.mlp.parameters()) && all_finite(critic_.mlp.parameters()) && all_finite(log_std_);
}

void PpoLearner::sample(Rollout& rollout, std::size_t sample, std::uint64_t step) {
  const std::size_t actions = rollout.actions;
  const auto mean = actor_.workspace.forward(actor_.mlp, rollout.observation_at(sample));
  const auto action = rollout.action_at(sample);
  std::ranges::copy(mean, rollout.mean_at(sample).begin());
  const Rng noise = rng_.split("policy");
  for (std::size_t environment = 0; environment < rollout.environments; ++environment) {
    const Rng stream = noise.split(environment);
    for (std::size_t d = 0; d < actions; ++d) {
      const std::size_t at = environment * actions + d;
      const double std = exp(static_cast<double>(log_std_[d]));
      action[at] = static_cast<float>(mean[at] + std * stream.normal(step * actions + d));
    }
  }
}

void PpoLearner::evaluate(Rollout& rollout) {
  log_density<float>({rollout.mean, log_std_}, rollout.action, rollout.log_density);
  values_of(rollout.observation, rollout.value);
  Buffer<float> last(rollout.environments);
  values_of(rollout.last_observation, last);
  rollout.last_value.assign(last.begin(), last.end());
  Buffer<float> terminal(rollout.truncated.size());
  values_of(rollout.terminal_observation, terminal);
  rollout.terminal_value.assign(terminal.begin(), terminal.end());
  estimate_returns(options_.returns(), rollout);
}

void PpoLearner::assess(Rollout& rollout) {
  evaluate(rollout);
  if (options_.advantage_scale == "rollout") standardise(rollout.advantage);
}

void PpoLearner::values_of(std::span<const float> observations, std::span<float> values) {
  const std::size_t width = critic_.mlp.shape().inputs();
  for (std::size_t first = 0; first < values.size(); first += critic_.workspace.max_lanes()) {
    const std::size_t lanes = std::min(critic_.workspace.max_lanes(), values.size() - first);
    const auto part = critic_.workspace.forward(critic_.mlp, observations.subspan(first * width, lanes * width));
    std::ranges::copy(part, values.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

PpoStep PpoLearner::update(const Rollout& rollout, double progress) {
  std::vector<std::uint32_t> all(rollout.samples());
  std::iota(all.begin(), all.end(), 0u);
  return update(rollout, all, progress);
}

PpoStep PpoLearner::update(const Rollout& rollout, std::span<const std::uint32_t> samples, double progress) {
  const auto batch = static_cast<std::size_t>(options_.minibatch);
  PpoStep last;
  if (samples.size() < batch) return last;
  order_.resize(samples.size());
  for (std::int64_t epoch = 0; epoch < options_.epochs; ++epoch) {
    shuffle(order_, rng_.split("minibatches").split(epochs_++));
    for (std::uint32_t& sample : order_) sample = samples[sample];
    for (std::size_t first = 0; first + batch <= order_.size(); first += batch)
      last = step(rollout, std::span(order_).subspan(first, batch), progress);
  }
  return last;
}

PpoStep PpoLearner::step(const Rollout& rollout, std::span<const std::uint32_t> samples, double progress) {
  gather(rollout, samples);
  PpoStep result;
  const auto mean = actor_.workspace.forward(actor_.mlp, observation_);
  log_density<float>({mean, log_std_}, action_, log_density_);
  result.policy = policy_loss<float>({log_density_, old_log_density_, advantage_}, options_.clip, at_log_density_);
  result.actor_moved = options_.target_kl <= 0.0 || result.policy.kl <= 1.5 * options_.target_kl;
  if (result.actor_moved) move_actor(mean, progress);
  actor_steps_ += result.actor_moved ? 1 : 0;
  ++critic_steps_;

  const auto value = critic_.workspace.forward(critic_.mlp, observation_);
  result.value_loss = value_loss<float>({value, target_, old_value_}, options_.value_clip, at_value_);
  critic_.workspace.backward(critic_.mlp, at_value_, critic_.gradient);
  const std::span<float> gradients[] = {critic_.gradient};
  clip_norm<float>(gradients, options_.max_grad_norm);
  adam_step<float>(adam_options(options_.critic_rate, progress), critic_.adam, critic_.mlp.parameters(),
                   critic_.gradient);
  return result;
}

void PpoLearner::gather(const Rollout& rollout, std::span<const std::uint32_t> samples) {
  pick_rows(rollout.observation, samples, rollout.observations, observation_);
  pick_rows(rollout.action, samples, rollout.actions, action_);
  pick(rollout.log_density, samples, old_log_density_);
  pick(rollout.value, samples, old_value_);
  pick(rollout.value_target, samples, target_);
  pick(rollout.advantage, samples, advantage_);
  if (options_.advantage_scale == "rollout") return;
  std::ranges::copy(advantage_, minibatch_advantage_.begin());
  standardise(minibatch_advantage_);
  std::ranges::transform(minibatch_advantage_, advantage_.begin(), [](double a) { return static_cast<float>(a); });
}

void PpoLearner::move_actor(std::span<const float> mean, double progress) {
  log_density_gradient<float>({mean, log_std_}, action_, at_log_density_, {at_mean_, log_std_gradient_});
  for (float& slope : log_std_gradient_) slope -= static_cast<float>(options_.entropy);
  actor_.workspace.backward(actor_.mlp, at_mean_, actor_.gradient);
  const std::span<float> gradients[] = {actor_.gradient, log_std_gradient_};
  clip_norm<float>(gradients, options_.max_grad_norm);
  const AdamOptions adam = adam_options(options_.actor_rate, progress);
  adam_step<float>(adam, actor_.adam, actor_.mlp.parameters(), actor_.gradient);
  adam_step<float>(adam, log_std_adam_, log_std_, log_std_gradient_);
}

AdamOptions PpoLearner::adam_options(double rate, double progress) const {
  const double left = options_.rate_decay == "linear" ? 1.0 - progress : 1.0;
  return {.rate = rate * left, .epsilon = options_.adam_epsilon};
}

}  // namespace gust
