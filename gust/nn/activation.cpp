#include "gust/nn/activation.h"

#include <cstddef>

namespace gust {
namespace {

/// Gradients of one block of columns that fits in registers: kCount times V.
template <Activation kind, class V, int kCount, class T>
void column_block(const T* y, T* dy, T* sums, std::size_t lanes, std::size_t width) {
  constexpr std::size_t kWidth = sizeof(V) / sizeof(T);
  V sum[kCount];
  for (int i = 0; i < kCount; ++i) sum[i] = load_as<V>(sums + i * kWidth);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    for (int i = 0; i < kCount; ++i) {
      const std::size_t at = lane * width + i * kWidth;
      const V dz = through_activation<kind, T>(load_as<V>(dy + at), load_as<V>(y + at));
      store_as(dy + at, dz);
      sum[i] += dz;
    }
  }
  for (int i = 0; i < kCount; ++i) store_as(sums + i * kWidth, sum[i]);
}

template <Activation kind, class T>
void all_columns(std::span<const T> y, std::span<T> dy, std::span<T> sums) {
  constexpr std::size_t kWidth = kVecWidth<T>;
  const std::size_t width = sums.size();
  const std::size_t lanes = dy.size() / width;
  std::size_t i = 0;
  for (; i + 8 * kWidth <= width; i += 8 * kWidth) column_block<kind, Vec<T>, 8>(&y[i], &dy[i], &sums[i], lanes, width);
  for (; i + kWidth <= width; i += kWidth) column_block<kind, Vec<T>, 1>(&y[i], &dy[i], &sums[i], lanes, width);
  for (; i < width; ++i) column_block<kind, T, 1>(&y[i], &dy[i], &sums[i], lanes, width);
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
  }
}

template <class T>
void add_bias(std::span<const T> bias, std::span<T> y) {
  const std::size_t width = bias.size();
  for (std::size_t start = 0; start < y.size(); start += width)
    for (std::size_t i = 0; i < width; ++i) y[start + i] += bias[i];
}

template <class T>
void add_columns(std::span<const T> dy, std::span<T> bias_gradient) {
  const std::size_t width = bias_gradient.size();
  for (std::size_t start = 0; start < dy.size(); start += width)
    for (std::size_t i = 0; i < width; ++i) bias_gradient[i] += dy[start + i];
}

template void add_bias_and_activate(Activation, std::span<const float>, std::span<float>);
template void add_bias_and_activate(Activation, std::span<const double>, std::span<double>);
template void add_bias(std::span<const float>, std::span<float>);
template void add_bias(std::span<const double>, std::span<double>);
template void through_activations(Activation, std::span<const float>, std::span<float>, std::span<float>);
template void through_activations(Activation, std::span<const double>, std::span<double>, std::span<double>);
template void add_columns(std::span<const float>, std::span<float>);
template void add_columns(std::span<const double>, std::span<double>);

}  // namespace gust
