#include "gust/agents/ppo_loss.h"

#include <algorithm>

#include "gust/core/math.h"

namespace gust {
namespace {

/// exp(a - b) of each pair, four at a time; `to` may be a or b.
template <class T>
void ratios(std::span<const T> a, std::span<const T> b, std::span<T> to) {
  for (std::size_t i = 0; i < to.size(); i += kPackLanes) {
    const std::size_t count = std::min(kPackLanes, to.size() - i);
    Pack difference{};
    for (std::size_t j = 0; j < count; ++j) difference[j] = static_cast<double>(a[i + j]) - b[i + j];
    const Pack ratio = exp(difference);
    for (std::size_t j = 0; j < count; ++j) to[i + j] = static_cast<T>(ratio[j]);
  }
}

}  // namespace

template <class T>
PolicyLoss policy_loss(const PolicySamples<T>& samples, double clip, std::span<T> gradient) noexcept {
  ratios(samples.log_density, samples.old_log_density, gradient);
  const double share = 1.0 / static_cast<double>(gradient.size());
  PolicyLoss sum;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    const double ratio = gradient[i];
    const double advantage = samples.advantage[i];
    const double own = ratio * advantage;
    const double bounded = gust::clip(ratio, 1.0 - clip, 1.0 + clip) * advantage;
    const bool active = own <= bounded;
    sum.loss -= active ? own : bounded;
    sum.kl += static_cast<double>(samples.old_log_density[i]) - samples.log_density[i];
    sum.clipped += active ? 0.0 : 1.0;
    gradient[i] = static_cast<T>(active ? -own * share : 0.0);
  }
  return {sum.loss * share, sum.kl * share, sum.clipped * share};
}

template <class T>
double value_loss(const ValueSamples<T>& samples, double clip, std::span<T> gradient) noexcept {
  const double share = 1.0 / static_cast<double>(gradient.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    const double error = static_cast<double>(samples.value[i]) - samples.target[i];
    double square = error * error;
    double slope = error;
    if (clip > 0.0) {
      const double moved = static_cast<double>(samples.value[i]) - samples.old_value[i];
      const double bounded = samples.old_value[i] + gust::clip(moved, -clip, clip) - samples.target[i];
      if (bounded * bounded > square) {
        square = bounded * bounded;
        slope = moved > -clip && moved < clip ? bounded : 0.0;
      }
    }
    sum += 0.5 * square;
    gradient[i] = static_cast<T>(slope * share);
  }
  return sum * share;
}

template PolicyLoss policy_loss(const PolicySamples<float>&, double, std::span<float>) noexcept;
template PolicyLoss policy_loss(const PolicySamples<double>&, double, std::span<double>) noexcept;
template double value_loss(const ValueSamples<float>&, double, std::span<float>) noexcept;
template double value_loss(const ValueSamples<double>&, double, std::span<double>) noexcept;

}  // namespace gust
