#include "gust/nn/adam.h"

#include <cmath>

#include "gust/nn/vec.h"

namespace gust {

template <class T>
void adam_step(const AdamOptions& options, AdamState<T>& state, std::span<T> parameters,
               std::span<T> gradient) noexcept {
  state.beta1_power *= options.beta1;
  state.beta2_power *= options.beta2;
  const T rate = static_cast<T>(options.rate / (1.0 - state.beta1_power));
  const T spread = static_cast<T>(1.0 / std::sqrt(1.0 - state.beta2_power));
  const T epsilon = static_cast<T>(options.epsilon);
  const T keep1 = static_cast<T>(options.beta1);
  const T keep2 = static_cast<T>(options.beta2);
  const T take1 = static_cast<T>(1.0 - options.beta1);
  const T take2 = static_cast<T>(1.0 - options.beta2);
  T* __restrict p = parameters.data();
  T* __restrict g = gradient.data();
  T* __restrict m = state.first.data();
  T* __restrict v = state.second.data();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    m[i] = fused(keep1, m[i], take1 * g[i]);
    v[i] = fused(keep2, v[i], take2 * g[i] * g[i]);
    p[i] -= rate * m[i] / fused(std::sqrt(v[i]), spread, epsilon);
    g[i] = 0;
  }
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

template void adam_step(const AdamOptions&, AdamState<float>&, std::span<float>, std::span<float>) noexcept;
template void adam_step(const AdamOptions&, AdamState<double>&, std::span<double>, std::span<double>) noexcept;
template void clip_norm(std::span<const std::span<float>>, double) noexcept;
template void clip_norm(std::span<const std::span<double>>, double) noexcept;

}  // namespace gust
