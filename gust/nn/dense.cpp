#include "gust/nn/dense.h"

#include "gust/nn/transpose.h"
#include "gust/nn/vec.h"

namespace gust {
namespace {

/// The elements of a vector added up by halves.
template <class T>
T sum_of(Vec<T> v) {
  for (std::size_t half = kVecWidth<T> / 2; half > 0; half /= 2)
    for (std::size_t i = 0; i < half; ++i) v[i] += v[i + half];
  return v[0];
}

/// Inner product of two rows: four vectors of partial sums, then what is left over, one by one.
template <class T>
T inner_product(const T* a, const T* b, std::size_t size) {
  using V = Vec<T>;
  constexpr std::size_t kWidth = kVecWidth<T>;
  V sum[4] = {};
  std::size_t i = 0;
  for (; i + 4 * kWidth <= size; i += 4 * kWidth)
    for (std::size_t part = 0; part < 4; ++part)
      sum[part] = fused(load_as<V>(a + i + part * kWidth), load_as<V>(b + i + part * kWidth), sum[part]);
  for (; i + kWidth <= size; i += kWidth) sum[0] = fused(load_as<V>(a + i), load_as<V>(b + i), sum[0]);
  T total = sum_of<T>((sum[0] + sum[1]) + (sum[2] + sum[3]));
  for (; i < size; ++i) total = fused(a[i], b[i], total);
  return total;
}

}  // namespace

template <class T>
LaneProduct<T>::LaneProduct(ProductShape shape, Steps steps, bool sum_over_lanes) : steps_(steps) {
  for (std::size_t size = 0; size < kBlocks.size(); ++size) {
    (sum_over_lanes ? shape.k : shape.n) = static_cast<int>(kBlocks[size]);
    products_[size] = Product<T>(shape);
  }
}

template <class T>
Dense<T>::Dense(DenseShape shape) : shape_(shape) {
  const int in = static_cast<int>(shape.inputs);
  const int out = static_cast<int>(shape.outputs);
  input_gradient_ = {{.m = in, .k = out}, {.b = shape.outputs, .c = shape.inputs}, false};
  if (shape.narrow()) {
    const ProductShape gradient = {.m = in, .n = out, .b_transposed = true, .accumulate = true};
    weight_gradient_ = {gradient, {.a = shape.inputs, .b = shape.outputs}, true};
  } else {
    const ProductShape gradient = {.m = out, .n = in, .b_transposed = true, .accumulate = true};
    weight_gradient_ = {gradient, {.a = shape.outputs, .b = shape.inputs}, true};
    forward_ = {{.m = out, .k = in}, {.b = shape.inputs, .c = shape.outputs}, false};
  }
}

template <class T>
void Dense<T>::forward(const T* weights, const T* x, T* y, std::size_t lanes) const noexcept {
  if (!shape_.narrow()) return forward_(weights, x, y, lanes);
  const std::size_t inputs = shape_.inputs;
  for (std::size_t lane = 0; lane < lanes; ++lane)
    for (std::size_t output = 0; output < shape_.outputs; ++output)
      *y++ = inner_product(x + lane * inputs, weights + output * inputs, inputs);
}

template <class T>
void Dense<T>::add_weight_gradient(const T* x, const T* dy, T* gradient, std::size_t lanes) const noexcept {
  shape_.narrow() ? weight_gradient_(x, dy, gradient, lanes) : weight_gradient_(dy, x, gradient, lanes);
}

template <class T>
const T* Dense<T>::output_major(const T* weights, T* scratch) const noexcept {
  if (shape_.narrow()) return weights;
  transpose(weights, scratch, shape_.inputs, shape_.outputs);
  return scratch;
}

template class LaneProduct<float>;
template class LaneProduct<double>;
template class Dense<float>;
template class Dense<double>;

}  // namespace gust
