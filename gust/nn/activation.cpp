#include "gust/nn/activation.h"

#include <cstddef>

namespace gust {
namespace {

struct Batch {
  std::size_t lanes;
  std::size_t width;
};

/// Gradients of one block of columns that fits in registers: kCount times V.
template <Activation kind, class V, std::size_t kCount, class T>
void column_block(const T* y, T* dy, T* sums, Batch batch) {
  constexpr std::size_t kWidth = sizeof(V) / sizeof(T);
  V sum[kCount];
  unrolled<kCount>([&](std::size_t i) { sum[i] = load_as<V>(sums + i * kWidth); });
  for (std::size_t lane = 0; lane < batch.lanes; ++lane) {
    unrolled<kCount>([&](std::size_t i) {
      const V dz = through_activation<kind, T>(load_as<V>(dy + i * kWidth), load_as<V>(y + i * kWidth));
      store_as(dy + i * kWidth, dz);
      sum[i] += dz;
    });
    y += batch.width;
    dy += batch.width;
  }
  unrolled<kCount>([&](std::size_t i) { store_as(sums + i * kWidth, sum[i]); });
}

/// A block of columns below a single output, from column `at` on.
template <Activation kind, class V, std::size_t kCount, class T>
void single_output_block(std::size_t at, const T* y, const SingleOutput<T>& output,
                         const ActivationGradient<T>& gradient) {
  constexpr std::size_t kWidth = sizeof(V) / sizeof(T);
  V weights[kCount], weight_sum[kCount], bias_sum[kCount];
  unrolled<kCount>([&](std::size_t i) {
    weights[i] = load_as<V>(&output.weights[at + i * kWidth]);
    weight_sum[i] = load_as<V>(&output.weight_gradient[at + i * kWidth]);
    bias_sum[i] = load_as<V>(&gradient.bias[at + i * kWidth]);
  });
  y += at;
  T* sums = gradient.sums.data() + at;
  for (const T dy : output.dy) {
    unrolled<kCount>([&](std::size_t i) {
      const V value = load_as<V>(y + i * kWidth);
      const V dz = through_activation<kind, T>(weights[i] * dy, value);
      store_as(sums + i * kWidth, dz);
      bias_sum[i] += dz;
      weight_sum[i] = fused(value, V{} + dy, weight_sum[i]);
    });
    y += output.weights.size();
    sums += output.weights.size();
  }
  unrolled<kCount>([&](std::size_t i) {
    store_as(&output.weight_gradient[at + i * kWidth], weight_sum[i]);
    store_as(&gradient.bias[at + i * kWidth], bias_sum[i]);
  });
}

template <Activation kind, class T>
void single_output(const T* y, const SingleOutput<T>& output, const ActivationGradient<T>& gradient) {
  constexpr std::size_t kWidth = kVecWidth<T>;
  const std::size_t width = output.weights.size();
  std::size_t i = 0;
  for (; i + 4 * kWidth <= width; i += 4 * kWidth) single_output_block<kind, Vec<T>, 4>(i, y, output, gradient);
  for (; i + kWidth <= width; i += kWidth) single_output_block<kind, Vec<T>, 1>(i, y, output, gradient);
  for (; i < width; ++i) single_output_block<kind, T, 1>(i, y, output, gradient);
}

template <Activation kind, class T>
void all_columns(std::span<const T> y, std::span<T> dy, std::span<T> sums) {
  constexpr std::size_t kWidth = kVecWidth<T>;
  const Batch batch = {dy.size() / sums.size(), sums.size()};
  std::size_t i = 0;
  for (; i + 8 * kWidth <= batch.width; i += 8 * kWidth) column_block<kind, Vec<T>, 8>(&y[i], &dy[i], &sums[i], batch);
  for (; i + kWidth <= batch.width; i += kWidth) column_block<kind, Vec<T>, 1>(&y[i], &dy[i], &sums[i], batch);
  for (; i < batch.width; ++i) column_block<kind, T, 1>(&y[i], &dy[i], &sums[i], batch);
}

template <Activation kind, class V, class T>
void activate_at(const T* bias, T* y) {
  store_as(y, activate<kind, T>(load_as<V>(y) + load_as<V>(bias)));
}

template <Activation kind, class T>
void all_lanes(std::span<const T> bias, std::span<T> y) {
  const std::size_t width = bias.size();
  for (std::size_t start = 0; start < y.size(); start += width) {
    std::size_t i = 0;
    for (; i + kVecWidth<T> <= width; i += kVecWidth<T>) activate_at<kind, Vec<T>>(&bias[i], &y[start + i]);
    for (; i < width; ++i) activate_at<kind, T>(&bias[i], &y[start + i]);
  }
}

}  // namespace

template <class T>
void add_bias_and_activate(Activation kind, std::span<const T> bias, std::span<T> y) {
  switch (kind) {
    case Activation::kTanh:
      return all_lanes<Activation::kTanh>(bias, y);
    case Activation::kRelu:
      return all_lanes<Activation::kRelu>(bias, y);
    case Activation::kLeakyRelu:
      return all_lanes<Activation::kLeakyRelu>(bias, y);
    case Activation::kIdentity:
      return all_lanes<Activation::kIdentity>(bias, y);
  }
}

template <class T>
void through_activations(Activation kind, std::span<const T> y, std::span<T> dy, std::span<T> bias_gradient) {
  switch (kind) {
    case Activation::kTanh:
      return all_columns<Activation::kTanh>(y, dy, bias_gradient);
    case Activation::kRelu:
      return all_columns<Activation::kRelu>(y, dy, bias_gradient);
    case Activation::kLeakyRelu:
      return all_columns<Activation::kLeakyRelu>(y, dy, bias_gradient);
    case Activation::kIdentity:
      return all_columns<Activation::kIdentity>(y, dy, bias_gradient);
  }
}

template <class T>
void through_single_output(Activation kind, std::span<const T> y, const SingleOutput<T>& output,
                           const ActivationGradient<T>& gradient) {
  switch (kind) {
    case Activation::kTanh:
      return single_output<Activation::kTanh>(y.data(), output, gradient);
    case Activation::kRelu:
      return single_output<Activation::kRelu>(y.data(), output, gradient);
    case Activation::kLeakyRelu:
      return single_output<Activation::kLeakyRelu>(y.data(), output, gradient);
    case Activation::kIdentity:
      return single_output<Activation::kIdentity>(y.data(), output, gradient);
  }
}

template <class T>
void add_columns(std::span<const T> dy, std::span<T> bias_gradient) {
  const std::size_t width = bias_gradient.size();
  for (std::size_t i = 0; i < width; ++i) {
    T sum = bias_gradient[i];
    for (std::size_t at = i; at < dy.size(); at += width) sum += dy[at];
    bias_gradient[i] = sum;
  }
}

template void add_bias_and_activate(Activation, std::span<const float>, std::span<float>);
template void add_bias_and_activate(Activation, std::span<const double>, std::span<double>);
template void through_activations(Activation, std::span<const float>, std::span<float>, std::span<float>);
template void through_activations(Activation, std::span<const double>, std::span<double>, std::span<double>);
template void through_single_output(Activation, std::span<const float>, const SingleOutput<float>&,
                                    const ActivationGradient<float>&);
template void through_single_output(Activation, std::span<const double>, const SingleOutput<double>&,
                                    const ActivationGradient<double>&);
template void add_columns(std::span<const float>, std::span<float>);
template void add_columns(std::span<const double>, std::span<double>);

}  // namespace gust
