#pragma once

#include <span>

#include "gust/core/math.h"
#include "gust/nn/vec.h"

namespace gust {

/// What a hidden layer does to its sums. kLeakyRelu has the slope 0.01 below zero; kIdentity leaves them as they are.
enum class Activation { kTanh, kRelu, kLeakyRelu, kIdentity };

namespace detail {

/// Single precision: a rational function of degree 7/8 that we fitted over |x| < 7.9 (tests/reference/nn/fit_tanh.py);
/// beyond, the result stays at the last value, which is within 3e-7 of one.
template <class V>
[[gnu::always_inline]] inline V tanh_rational(V x) {
  constexpr float kEnd = 7.9f;
  const V y = lesser(V{} + kEnd, greater(V{} - kEnd, x));
  const V z = y * y;
  V p = fused(V{} + 1.14146801e-05f, z, V{} + 2.94851177e-03f);
  p = fused(fused(p, z, V{} + 1.29226856e-01f), z, V{} + 9.99999426e-01f);
  V q = fused(V{} + 2.45724132e-07f, z, V{} + 2.38395435e-04f);
  q = fused(fused(fused(q, z, V{} + 2.38035126e-02f), z, V{} + 4.62558062e-01f), z, V{} + 1.0f);
  return y * p / q;
}

/// Double precision, for the oracles: by the exponential function, and by the series at zero where that cancels.
template <class V>
V tanh_exponential(V x) {
  const V z = x * x;
  const V series = x * fused(z, fused(z, fused(z, V{} - 17.0 / 315.0, V{} + 2.0 / 15.0), V{} - 1.0 / 3.0), V{} + 1.0);
  const V size = absolute(x);
  const V large = 1.0 - 2.0 / (exp(2.0 * size) + 1.0);
  return select(size < 0.02, series, select(x < 0.0, -large, large));
}

}  // namespace detail

/// The activation of a sum z. V is T or a vector of T, with the same bits. In float, tanh is within 5e-7 of the true
/// value, never beyond -1 … 1, and NaN for NaN.
template <Activation kind, class T, class V>
[[gnu::always_inline]] inline V activate(V z) {
  if constexpr (kind == Activation::kTanh && sizeof(T) == sizeof(float)) return detail::tanh_rational(z);
  if constexpr (kind == Activation::kTanh && sizeof(T) == sizeof(double)) return detail::tanh_exponential(z);
  if constexpr (kind == Activation::kRelu) return greater(V{}, z);
  if constexpr (kind == Activation::kLeakyRelu) return greater(z * T(0.01), z);
  if constexpr (kind == Activation::kIdentity) return z;
}

/// The gradient at the sum, from the gradient dy at the activation y = activate(z). V is T or a vector of T.
template <Activation kind, class T, class V>
V through_activation(V dy, V y) {
  if constexpr (kind == Activation::kTanh) return dy * fused(-y, y, V{} + T(1));
  if constexpr (kind == Activation::kRelu) return y > V{} ? dy : V{};
  if constexpr (kind == Activation::kLeakyRelu) return y > V{} ? dy : dy * T(0.01);
  if constexpr (kind == Activation::kIdentity) return dy;
}

/// y = activate(y + bias) for every lane of a batch (lanes x width, the features of a lane side by side).
template <class T>
void add_bias_and_activate(Activation kind, std::span<const T> bias, std::span<T> y);

/// Turns the gradient dy at activations y into the gradient at their sums, in place, and adds its columns up over the
/// lanes, in their order, onto bias_gradient.
template <class T>
void through_activations(Activation kind, std::span<const T> y, std::span<T> dy, std::span<T> bias_gradient);

template <class T>
struct ActivationGradient {
  std::span<T> sums;  ///< lanes x width, overwritten
  std::span<T> bias;  ///< added onto
};

/// A layer of one output above some activations, and the gradient dy [lanes] at that output.
template <class T>
struct SingleOutput {
  std::span<const T> weights;
  std::span<const T> dy;
  std::span<T> weight_gradient;  ///< added onto
};

/// In one pass, to the same bits: the gradient of the output's weights, and dz = through_activations of dy times the
/// weights, which is written.
template <class T>
void through_single_output(Activation kind, std::span<const T> y, const SingleOutput<T>& output,
                           const ActivationGradient<T>& gradient);

/// Adds the columns of dy up over the lanes, in their order, onto bias_gradient.
template <class T>
void add_columns(std::span<const T> dy, std::span<T> bias_gradient);

}  // namespace gust
