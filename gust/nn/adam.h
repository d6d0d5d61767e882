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

/// The numbers of one step, equal for all parameters. It counts the step in the state.
template <class T>
struct AdamStep {
  AdamStep(const AdamOptions& options, AdamState<T>& state);

  T rate, spread, epsilon, keep1, keep2, take1, take2;
};

/// Some parameters with all that a step needs of them; equally long.
template <class T>
struct AdamPart {
  std::span<T> parameters;
  std::span<const T> gradient;
  std::span<T> first;
  std::span<T> second;
};

/// Moves a part of the parameters along their gradient. Parts may be done one after the other, as their gradients
/// become known and are still in the near caches.
template <class T>
void adam_move(const AdamStep<T>& step, AdamPart<T> part) noexcept;

/// What follows some parameters slowly: target = target + share (parameters - target).
template <class T>
struct TargetNetwork {
  std::span<T> target;
  T share;
};

/// The same, and after it the target network's step towards the new parameters, in one pass over the memory.
template <class T>
void adam_move(const AdamStep<T>& step, AdamPart<T> part, TargetNetwork<T> target_network) noexcept;

/// One step of all parameters along a gradient, which is cleared for the next sum.
template <class T>
void adam_step(const AdamOptions& options, AdamState<T>& state, std::span<T> parameters,
               std::span<T> gradient) noexcept;

/// Scales gradients so that their common L2 norm is at most `limit`; a limit of 0 leaves them alone.
template <class T>
void clip_norm(std::span<const std::span<T>> gradients, double limit) noexcept;

}  // namespace gust
