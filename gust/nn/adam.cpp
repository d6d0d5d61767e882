#include "gust/nn/adam.h"

#include <cmath>

#include "gust/nn/vec.h"

namespace gust {

template <class T>
AdamStep<T>::AdamStep(const AdamOptions& options, AdamState<T>& state) {
  state.beta1_power *= options.beta1;
  state.beta2_power *= options.beta2;
  rate = static_cast<T>(options.rate / (1.0 - state.beta1_power));
  spread = static_cast<T>(1.0 / std::sqrt(1.0 - state.beta2_power));
  epsilon = static_cast<T>(options.epsilon);
  keep1 = static_cast<T>(options.beta1);
  keep2 = static_cast<T>(options.beta2);
  take1 = static_cast<T>(1.0 - options.beta1);
  take2 = static_cast<T>(1.0 - options.beta2);
}

namespace {

/// Moves parameters; `then(i, p)` is told each new one.
template <class T, class Then>
[[gnu::always_inline]] inline void move_all(const AdamStep<T> step, const AdamPart<T>& part, Then&& then) {
  T* __restrict p = part.parameters.data();
  const T* g = part.gradient.data();
  T* __restrict m = part.first.data();
  T* __restrict v = part.second.data();
  for (std::size_t i = 0; i < part.parameters.size(); ++i) {
    m[i] = fused(step.keep1, m[i], step.take1 * g[i]);
    v[i] = fused(step.keep2, v[i], step.take2 * g[i] * g[i]);
    p[i] -= step.rate * m[i] / fused(std::sqrt(v[i]), step.spread, step.epsilon);
    then(i, p[i]);
  }
}

}  // namespace

template <class T>
void adam_move(const AdamStep<T>& step, AdamPart<T> part) noexcept {
  move_all(step, part, [](std::size_t, T) {});
}

template <class T>
void adam_move(const AdamStep<T>& step, AdamPart<T> part, TargetNetwork<T> target_network) noexcept {
  T* __restrict target = target_network.target.data();
  const T share = target_network.share;
  move_all(step, part, [=](std::size_t i, T p) { target[i] = fused(share, p - target[i], target[i]); });
}

template <class T>
void adam_step(const AdamOptions& options, AdamState<T>& state, std::span<T> parameters,
               std::span<T> gradient) noexcept {
  T* __restrict g = gradient.data();
  move_all(AdamStep<T>(options, state), {parameters, gradient, state.first, state.second},
           [g](std::size_t i, T) { g[i] = 0; });
}

template <class T>
void clip_norm(std::span<const std::span<T>> gradients, double limit) noexcept {
  if (limit <= 0.0) return;
  double square = 0.0;
  for (const std::span<T> gradient : gradients)
    for (const T value : gradient) square += static_cast<double>(value) * value;
  const double norm = std::sqrt(square);
  if (!(norm > limit)) return;
  const T scale = static_cast<T>(limit / norm);
  for (const std::span<T> gradient : gradients)
    for (T& value : gradient) value *= scale;
}

template struct AdamStep<float>;
template struct AdamStep<double>;
template void adam_move(const AdamStep<float>&, AdamPart<float>) noexcept;
template void adam_move(const AdamStep<double>&, AdamPart<double>) noexcept;
template void adam_move(const AdamStep<float>&, AdamPart<float>, TargetNetwork<float>) noexcept;
template void adam_move(const AdamStep<double>&, AdamPart<double>, TargetNetwork<double>) noexcept;
template void adam_step(const AdamOptions&, AdamState<float>&, std::span<float>, std::span<float>) noexcept;
template void adam_step(const AdamOptions&, AdamState<double>&, std::span<double>, std::span<double>) noexcept;
template void clip_norm(std::span<const std::span<float>>, double) noexcept;
template void clip_norm(std::span<const std::span<double>>, double) noexcept;

}  // namespace gust
