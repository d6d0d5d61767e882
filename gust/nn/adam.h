#pragma once

#include <cstddef>
#include <span>

#include "gust/nn/buffer.h"

namespace gust {

/// Adam (Kingma and Ba 2015): epsilon outside the square root, both moments corrected for their start at zero.
///
///   m = b1 m + (1 - b1) g          v = b2 v + (1 - b2) g^2
///   p = p - rate mhat / (sqrt(vhat) + epsilon)        mhat = m / (1 - b1^t)   vhat = v / (1 - b2^t)
struct AdamOptions {
  double rate = 1e-3;
  double beta1 = 0.9;
  double beta2 = 0.999;
  double epsilon = 1e-8;
};

/// What Adam remembers of some parameters.
template <class T>
struct AdamState {
  AdamState() = default;
  explicit AdamState(std::size_t parameters) : first(parameters), second(parameters) {}

  Buffer<T> first;
  Buffer<T> second;
  double beta1_power = 1.0;  ///< beta1 to the number of steps done
  double beta2_power = 1.0;
};

/// One step along a gradient, which is cleared for the next sum.
template <class T>
void adam_step(const AdamOptions& options, AdamState<T>& state, std::span<T> parameters,
               std::span<T> gradient) noexcept;

/// Scales gradients so that their common L2 norm is at most `limit`; a limit of 0 leaves them alone.
template <class T>
void clip_norm(std::span<const std::span<T>> gradients, double limit) noexcept;

}  // namespace gust
