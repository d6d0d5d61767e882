#pragma once

#include <span>

namespace gust {

/// What a policy did in some samples, then and now.
template <class T>
struct PolicySamples {
  std::span<const T> log_density;      ///< of the actions under the present policy
  std::span<const T> old_log_density;  ///< under the policy that drew them
  std::span<const T> advantage;
};

struct PolicyLoss {
  double loss = 0;     ///< -mean(min(ratio A, clip(ratio, 1 - c, 1 + c) A)), ratio = exp(log_density - old)
  double kl = 0;       ///< mean(old - log_density), which may be negative
  double clipped = 0;  ///< share of the samples without a gradient
};

/// PPO's policy loss; writes its gradient at the log densities: -A ratio / B where the minimum is the ratio's own
/// branch, else 0.
template <class T>
PolicyLoss policy_loss(const PolicySamples<T>& samples, double clip, std::span<T> gradient) noexcept;

template <class T>
struct ValueSamples {
  std::span<const T> value;
  std::span<const T> target;
  std::span<const T> old_value;  ///< of the critic at the rollout; needed for a clip only
};

/// Half the mean squared error; with a clip > 0 that of the worse of the value and the old value moved by at most the
/// clip. Writes the gradient at the values.
template <class T>
double value_loss(const ValueSamples<T>& samples, double clip, std::span<T> gradient) noexcept;

}  // namespace gust
