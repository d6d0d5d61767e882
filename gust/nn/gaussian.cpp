#include "gust/nn/gaussian.h"

#include <algorithm>

#include "gust/core/math.h"

namespace gust {
namespace {

constexpr double kHalfLogTwoPi = 0.91893853320467274178;
constexpr double kHalfLogTwoPiE = 1.41893853320467274178;

/// 1 / std.
template <class T>
T inverse_std(T log_std) {
  return static_cast<T>(exp(-static_cast<double>(log_std)));
}

}  // namespace

template <class T>
void log_density(const Gaussian<T>& gaussian, std::span<const T> action, std::span<T> log_density) noexcept {
  const std::size_t actions = gaussian.actions();
  std::ranges::fill(log_density, T(0));
  for (std::size_t d = 0; d < actions; ++d) {
    const T inverse = inverse_std(gaussian.log_std[d]);
    const T offset = static_cast<T>(gaussian.log_std[d] + kHalfLogTwoPi);
    for (std::size_t lane = 0; lane < log_density.size(); ++lane) {
      const T z = (action[lane * actions + d] - gaussian.mean[lane * actions + d]) * inverse;
      log_density[lane] -= T(0.5) * z * z + offset;
    }
  }
}

template <class T>
double entropy(std::span<const T> log_std) noexcept {
  double sum = 0.0;
  for (const T value : log_std) sum += kHalfLogTwoPiE + static_cast<double>(value);
  return sum;
}

template <class T>
void log_density_gradient(const Gaussian<T>& gaussian, std::span<const T> action, std::span<const T> at_log_density,
                          GaussianGradient<T> gradient) noexcept {
  const std::size_t actions = gaussian.actions();
  for (std::size_t d = 0; d < actions; ++d) {
    const T inverse = inverse_std(gaussian.log_std[d]);
    double sum = 0.0;
    for (std::size_t lane = 0; lane < at_log_density.size(); ++lane) {
      const std::size_t at = lane * actions + d;
      const T z = (action[at] - gaussian.mean[at]) * inverse;
      gradient.mean[at] = at_log_density[lane] * z * inverse;
      sum += static_cast<double>(at_log_density[lane]) * (static_cast<double>(z) * z - 1.0);
    }
    gradient.log_std[d] += static_cast<T>(sum);
  }
}

template void log_density(const Gaussian<float>&, std::span<const float>, std::span<float>) noexcept;
template void log_density(const Gaussian<double>&, std::span<const double>, std::span<double>) noexcept;
template double entropy(std::span<const float>) noexcept;
template double entropy(std::span<const double>) noexcept;
template void log_density_gradient(const Gaussian<float>&, std::span<const float>, std::span<const float>,
                                   GaussianGradient<float>) noexcept;
template void log_density_gradient(const Gaussian<double>&, std::span<const double>, std::span<const double>,
                                   GaussianGradient<double>) noexcept;

}  // namespace gust
