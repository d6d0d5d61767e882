#include "gust/agents/ppo_loss.h"

#include <algorithm>
#include <array>

#include "gust/core/math.h"

namespace gust {
namespace {

constexpr std::size_t kBlock = 16;  // samples at a time

/// exp(a - b) of up to kBlock pairs.
template <class T>
std::array<double, kBlock> ratios(std::span<const T> a, std::span<const T> b) {
  std::array<double, kBlock> ratio = {};
  for (std::size_t i = 0; i < a.size(); ++i) ratio[i] = static_cast<double>(a[i]) - b[i];
  for (std::size_t i = 0; i < kBlock; i += kPackLanes) store(&ratio[i], exp(load(&ratio[i])));
  return ratio;
}

}  // namespace

template <class T>
PolicyLoss policy_loss(const PolicySamples<T>& samples, double clip, std::span<T> gradient) noexcept {
  const double share = 1.0 / static_cast<double>(gradient.size());
  PolicyLoss sum;
  for (std::size_t first = 0; first < gradient.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, gradient.size() - first);
    const auto now = samples.log_density.subspan(first, count);
    const auto old = samples.old_log_density.subspan(first, count);
    const auto ratio = ratios(now, old);
    for (std::size_t i = 0; i < count; ++i) {
      const double advantage = samples.advantage[first + i];
      const double own = ratio[i] * advantage;
      const double bounded = gust::clip(ratio[i], 1.0 - clip, 1.0 + clip) * advantage;
      const bool active = own <= bounded;
      sum.loss -= active ? own : bounded;
      sum.kl += static_cast<double>(old[i]) - now[i];
      sum.clipped += active ? 0.0 : 1.0;
      gradient[first + i] = static_cast<T>(active ? -own * share : 0.0);
    }
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
