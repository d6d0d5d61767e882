#include "gust/agents/rollout.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace gust {

Rollout::Rollout(std::size_t environment_count, std::size_t step_count, std::size_t observation_size,
                 std::size_t action_size)
    : environments(environment_count),
      steps(step_count),
      observations(observation_size),
      actions(action_size),
      observation(samples() * observations),
      action(samples() * actions),
      mean(samples() * actions),
      last_observation(environments * observations),
      reward(samples()),
      done(samples()),
      log_density(samples()),
      value(samples()),
      last_value(environments),
      advantage(samples()),
      value_target(samples()) {}

void oppose(const Rollout& rollout, Rollout& opponent) {
  opponent.observation = rollout.observation;
  opponent.last_observation = rollout.last_observation;
  opponent.done = rollout.done;
  opponent.truncated = rollout.truncated;
  opponent.terminal_observation = rollout.terminal_observation;
  std::ranges::transform(rollout.reward, opponent.reward.begin(), std::negate<>());
}

void estimate_returns(const ReturnOptions& options, Rollout& rollout) {
  std::vector<double> followed(rollout.reward);
  for (std::size_t i = 0; i < rollout.truncated.size(); ++i)
    followed[rollout.truncated[i]] += options.discount * rollout.terminal_value[i];
  for (std::size_t environment = 0; environment < rollout.environments; ++environment) {
    double next_return = rollout.last_value[environment];
    double next_value = next_return;
    double next_advantage = 0.0;
    for (std::size_t step = rollout.steps; step-- > 0;) {
      const std::size_t sample = step * rollout.environments + environment;
      const double keep = rollout.done[sample] ? 0.0 : options.discount;
      const double value = rollout.value[sample];
      next_return = followed[sample] + keep * next_return;
      next_advantage = options.use_gae
                           ? followed[sample] + keep * next_value - value + keep * options.lambda * next_advantage
                           : next_return - value;
      next_value = value;
      rollout.advantage[sample] = next_advantage;
      rollout.value_target[sample] = options.td_lambda_target ? next_advantage + value : next_return;
    }
  }
}

void standardise(std::span<double> values) noexcept {
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) mean += value;
  mean /= count;
  double variance = 0.0;
  for (const double value : values) variance += (value - mean) * (value - mean);
  const double scale = 1.0 / (std::sqrt(variance / count) + 1e-6);
  for (double& value : values) value = (value - mean) * scale;
}

}  // namespace gust
