#include "gust/nn/squashed_gaussian.h"

#include <algorithm>

#include "gust/core/math.h"

namespace gust {
namespace {

constexpr double kHalfLogTwoPi = 0.91893853320467274178;
constexpr double kLogTwo = 0.69314718055994530942;

/// Some lanes in double: one, or a pack.
template <class V, class T>
V load(const T* from) {
  if constexpr (sizeof(V) == sizeof(double))
    return static_cast<double>(*from);
  else
    return V{static_cast<double>(from[0]), static_cast<double>(from[1]), static_cast<double>(from[2]),
             static_cast<double>(from[3])};
}

template <class V, class T>
void store(T* to, V value) {
  if constexpr (sizeof(V) == sizeof(double))
    *to = static_cast<T>(value);
  else
    for (std::size_t i = 0; i < kPackLanes; ++i) to[i] = static_cast<T>(value[i]);
}

/// Calls f for all lanes, in packs while there are whole ones; the bits are the same.
template <class F>
void for_all_lanes(std::size_t lanes, F&& f) {
  std::size_t lane = 0;
  for (; lane + kPackLanes <= lanes; lane += kPackLanes) f.template operator()<Pack>(lane);
  for (; lane < lanes; ++lane) f.template operator()<double>(lane);
}

/// tanh u, 1 - tanh^2 u and its logarithm, all from t = exp(-2 |u|): nothing cancels, nothing overflows.
template <class V>
struct Squashed {
  V tanh;
  V slope;
  V log_slope;
};

template <class V>
Squashed<V> squashed(V u) {
  const V size = absolute(u);
  const V t = exp(-2.0 * size);
  const V inverse = 1.0 / (1.0 + t);
  const V tanh = (1.0 - t) * inverse;
  return {select(u < 0.0, -tanh, tanh), 4.0 * t * inverse * inverse, 2.0 * (kLogTwo - size - log(1.0 + t))};
}

template <class V>
V clamped(V log_std) {
  return clip(log_std, V{} + kLogStdLow, V{} + kLogStdHigh);
}

template <class V, class T>
void sample_at(const SquashedGaussian<T>& policy, std::span<const T> noise, SquashedSample<T> sample,
               std::size_t lane) {
  V density{};
  for (std::size_t d = 0; d < policy.actions(); ++d) {
    const std::size_t at = d * policy.lanes() + lane;
    const V e = load<V>(&noise[at]);
    const V log_std = clamped(load<V>(&policy.log_std[at]));
    const Squashed<V> y = squashed(load<V>(&policy.mean[at]) + exp(log_std) * e);
    const double half_width = policy.half_width[d];
    store<V>(&sample.action[at], policy.centre[d] + half_width * y.tanh);
    density -= 0.5 * e * e + log_std + kHalfLogTwoPi + y.log_slope + (policy.of_tanh ? 0.0 : log(half_width));
  }
  store<V>(&sample.log_density[lane], density);
}

template <class T>
struct GradientTask {
  const SquashedGaussian<T>& policy;
  std::span<const T> noise;
  SquashedSample<const T> at;
  SquashedGradient<T> gradient;
};

template <class V, class T>
void gradient_at(const GradientTask<T>& task, std::size_t lane) {
  const SquashedGaussian<T>& policy = task.policy;
  const V at_density = load<V>(&task.at.log_density[lane]);
  for (std::size_t d = 0; d < policy.actions(); ++d) {
    const std::size_t at = d * policy.lanes() + lane;
    const V raw = load<V>(&policy.log_std[at]);
    const V log_std = clamped(raw);
    const V spread = exp(log_std) * load<V>(&task.noise[at]);
    const Squashed<V> y = squashed(load<V>(&policy.mean[at]) + spread);
    const V at_action = load<V>(&task.at.action[at]);
    const V at_u = at_action * static_cast<double>(policy.half_width[d]) * y.slope + at_density * 2.0 * y.tanh;
    store<V>(&task.gradient.mean[at], at_u);
    store<V>(&task.gradient.log_std[at], select(log_std == raw, at_u * spread - at_density, V{}));
  }
}

}  // namespace

template <class T>
void squashed_sample(const SquashedGaussian<T>& policy, std::span<const T> noise, SquashedSample<T> sample) noexcept {
  for_all_lanes(policy.lanes(), [&]<class V>(std::size_t lane) { sample_at<V>(policy, noise, sample, lane); });
}

template <class T>
void squashed_gradient(const SquashedGaussian<T>& policy, std::span<const T> noise, SquashedSample<const T> at_sample,
                       SquashedGradient<T> gradient) noexcept {
  const GradientTask<T> task{policy, noise, at_sample, gradient};
  for_all_lanes(policy.lanes(), [&]<class V>(std::size_t lane) { gradient_at<V>(task, lane); });
}

template void squashed_sample(const SquashedGaussian<float>&, std::span<const float>, SquashedSample<float>) noexcept;
template void squashed_sample(const SquashedGaussian<double>&, std::span<const double>,
                              SquashedSample<double>) noexcept;
template void squashed_gradient(const SquashedGaussian<float>&, std::span<const float>, SquashedSample<const float>,
                                SquashedGradient<float>) noexcept;
template void squashed_gradient(const SquashedGaussian<double>&, std::span<const double>, SquashedSample<const double>,
                                SquashedGradient<double>) noexcept;

}  // namespace gust
