#include "gust/nn/squashed_gaussian.h"

#include <algorithm>

#include "gust/core/math.h"

namespace gust {
namespace {

constexpr double kHalfLogTwoPi = 0.91893853320467274178;
constexpr double kLogTwo = 0.69314718055994530942;

/// tanh u, 1 - tanh^2 u and its logarithm, all from t = exp(-2 |u|): nothing cancels, nothing overflows.
struct Squashed {
  double tanh;
  double slope;
  double log_slope;
};

Squashed squashed(double u) {
  const double size = absolute(u);
  const double t = exp(-2.0 * size);
  const double inverse = 1.0 / (1.0 + t);
  const double tanh = (1.0 - t) * inverse;
  return {u < 0.0 ? -tanh : tanh, 4.0 * t * inverse * inverse, 2.0 * (kLogTwo - size - log(1.0 + t))};
}

double clamped(double log_std) { return clip(log_std, kLogStdLow, kLogStdHigh); }

}  // namespace

template <class T>
void squashed_sample(const SquashedGaussian<T>& policy, std::span<const T> noise, SquashedSample<T> sample) noexcept {
  const std::size_t lanes = policy.lanes();
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    double density = 0.0;
    for (std::size_t d = 0; d < policy.actions(); ++d) {
      const std::size_t at = d * lanes + lane;
      const double e = noise[at];
      const double log_std = clamped(policy.log_std[at]);
      const Squashed y = squashed(policy.mean[at] + exp(log_std) * e);
      sample.action[at] = static_cast<T>(policy.centre[d] + policy.half_width[d] * y.tanh);
      density -= 0.5 * e * e + log_std + kHalfLogTwoPi + y.log_slope + log(static_cast<double>(policy.half_width[d]));
    }
    sample.log_density[lane] = static_cast<T>(density);
  }
}

template <class T>
void squashed_gradient(const SquashedGaussian<T>& policy, std::span<const T> noise, SquashedSample<const T> at_sample,
                       SquashedGradient<T> gradient) noexcept {
  const std::size_t lanes = policy.lanes();
  for (std::size_t d = 0; d < policy.actions(); ++d) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t at = d * lanes + lane;
      const double log_std = clamped(policy.log_std[at]);
      const double spread = exp(log_std) * noise[at];
      const Squashed y = squashed(policy.mean[at] + spread);
      const double at_density = at_sample.log_density[lane];
      const double at_u = at_sample.action[at] * policy.half_width[d] * y.slope + at_density * 2.0 * y.tanh;
      gradient.mean[at] = static_cast<T>(at_u);
      gradient.log_std[at] = log_std == policy.log_std[at] ? static_cast<T>(at_u * spread - at_density) : T(0);
    }
  }
}

template void squashed_sample(const SquashedGaussian<float>&, std::span<const float>, SquashedSample<float>) noexcept;
template void squashed_sample(const SquashedGaussian<double>&, std::span<const double>,
                              SquashedSample<double>) noexcept;
template void squashed_gradient(const SquashedGaussian<float>&, std::span<const float>, SquashedSample<const float>,
                                SquashedGradient<float>) noexcept;
template void squashed_gradient(const SquashedGaussian<double>&, std::span<const double>, SquashedSample<const double>,
                                SquashedGradient<double>) noexcept;

}  // namespace gust
