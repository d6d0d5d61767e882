#pragma once

#include <cstddef>
#include <span>

namespace gust {

/// A Gaussian with a mean from a network and one learned log standard deviation per action, the same in all states.
/// Batches are lanes x actions, the actions of a lane side by side.
template <class T>
struct Gaussian {
  std::span<const T> mean;     ///< lanes x actions
  std::span<const T> log_std;  ///< per action

  std::size_t actions() const { return log_std.size(); }
  std::size_t lanes() const { return mean.size() / log_std.size(); }
};

/// log_density[lane] = sum over d of -1/2 ((a_d - mean_d) / std_d)^2 - log std_d - 1/2 ln 2 pi.
template <class T>
void log_density(const Gaussian<T>& gaussian, std::span<const T> action, std::span<T> log_density) noexcept;

/// Differential entropy, sum over d of 1/2 ln(2 pi e) + log std_d; the same in every lane.
template <class T>
double entropy(std::span<const T> log_std) noexcept;

template <class T>
struct GaussianGradient {
  std::span<T> mean;     ///< lanes x actions, overwritten
  std::span<T> log_std;  ///< per action, added onto
};

/// From the gradient of a loss at the log densities of `action`: (a - mean) / std^2 and ((a - mean) / std)^2 - 1.
template <class T>
void log_density_gradient(const Gaussian<T>& gaussian, std::span<const T> action, std::span<const T> at_log_density,
                          GaussianGradient<T> gradient) noexcept;

}  // namespace gust
