#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gust/nn/buffer.h"

namespace gust {

/// What some environments gave in some steps. Sample t E + e is step t of environment e of E; the numbers of a sample
/// lie side by side.
struct Rollout {
  Rollout(std::size_t environments, std::size_t steps, std::size_t observations, std::size_t actions);

  std::size_t environments;
  std::size_t steps;
  std::size_t observations;
  std::size_t actions;

  Buffer<float> observation;       ///< samples x observations
  Buffer<float> action;            ///< samples x actions, as drawn
  Buffer<float> mean;              ///< samples x actions, of the policy that drew them
  Buffer<float> last_observation;  ///< environments x observations, after the last step
  std::vector<double> reward;
  std::vector<std::uint8_t> done;

  /// Episodes that ended by time alone, in the order of their samples: which, and the observations they ended with.
  std::vector<std::size_t> truncated;
  Buffer<float> terminal_observation;

  // Filled in by a learner.
  Buffer<float> log_density;           ///< of the action under the policy that drew it
  Buffer<float> value;                 ///< of the observation
  std::vector<double> last_value;      ///< per environment
  std::vector<double> terminal_value;  ///< of truncated episodes
  std::vector<double> advantage;
  std::vector<double> value_target;

  std::size_t samples() const { return environments * steps; }
  std::span<float> observation_at(std::size_t sample) {
    return std::span(observation).subspan(sample * observations, environments * observations);
  }
  std::span<float> action_at(std::size_t sample) {
    return std::span(action).subspan(sample * actions, environments * actions);
  }
  std::span<float> mean_at(std::size_t sample) {
    return std::span(mean).subspan(sample * actions, environments * actions);
  }
};

/// Fills in an opponent's side of the same steps: equal but for the rewards, which are negated; the actions stay its
/// own.
void oppose(const Rollout& rollout, Rollout& opponent);

/// How returns are estimated (docs/algorithms.md 1.2).
struct ReturnOptions {
  double discount = 0.99;
  double lambda = 0.95;
  bool use_gae = false;           ///< advantages by generalised estimation, else R - v
  bool td_lambda_target = false;  ///< the value target is advantage + v, else the return R whatever the advantages
};

/// Fills value_target and advantage from rewards and values; where an episode was truncated, the value of its last
/// observation takes the place of what would have followed.
///
///   r'_t = r_t + discount vT_t      k_t = 1 - done_t
///   R_t = r'_t + discount k_t R_{t+1}                        R_T = v_T
///   A_t = r'_t + discount k_t v_{t+1} - v_t + discount lambda k_t A_{t+1}     (or R_t - v_t)
void estimate_returns(const ReturnOptions& options, Rollout& rollout);

/// Subtracts the mean and divides by the population's standard deviation + 1e-6.
void standardise(std::span<double> values) noexcept;

}  // namespace gust
