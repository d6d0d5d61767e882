#pragma once

#include <cstddef>
#include <span>

namespace gust {

inline constexpr double kLogStdLow = -20.0;
inline constexpr double kLogStdHigh = 2.0;

/// A Gaussian pressed through tanh and stretched over a box (docs/algorithms.md 2.2); its mean and its deviation depend
/// on the state:
///
///   u = mean + exp(log_std) noise        a = centre + half_width tanh u
///   log pi(a) = sum over d of -1/2 noise_d^2 - log_std_d - 1/2 ln 2 pi - 2 (ln 2 - u_d - softplus(-2 u_d))
///               - ln half_width_d
///
/// The last two terms are the logarithm of da/du; in this form it stays exact where tanh is one. log_std is clamped to
/// [-20, 2]. Batches are component x lanes: the lanes of a component lie side by side. All is computed in double.
template <class T>
struct SquashedGaussian {
  std::span<const T> mean;     ///< actions x lanes
  std::span<const T> log_std;  ///< actions x lanes, not clamped yet
  std::span<const float> centre;
  std::span<const float> half_width;  ///< per action
  bool of_tanh = false;               ///< leave out ln half_width: the density of tanh u, not of the action

  std::size_t actions() const { return centre.size(); }
  std::size_t lanes() const { return mean.size() / centre.size(); }
};

template <class T>
struct SquashedSample {
  std::span<T> action;       ///< actions x lanes
  std::span<T> log_density;  ///< per lane
};

/// The actions that standard normal noise (actions x lanes) leads to, and the logarithms of their densities.
template <class T>
void squashed_sample(const SquashedGaussian<T>& policy, std::span<const T> noise, SquashedSample<T> sample) noexcept;

template <class T>
struct SquashedGradient {
  std::span<T> mean;     ///< actions x lanes, overwritten
  std::span<T> log_std;  ///< actions x lanes, overwritten; zero where the clamp holds
};

/// From the gradients of a loss at the actions (actions x lanes) and at their log densities (per lane), the noise held
/// (reparameterised): da/du = half_width (1 - tanh^2 u), dlog pi/du = 2 tanh u, du/dlog_std = exp(log_std) noise, and
/// log_std itself lowers log pi.
template <class T>
void squashed_gradient(const SquashedGaussian<T>& policy, std::span<const T> noise, SquashedSample<const T> at,
                       SquashedGradient<T> gradient) noexcept;

}  // namespace gust
