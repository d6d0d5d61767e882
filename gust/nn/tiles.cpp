#include "gust/nn/tiles.h"

#include "gust/nn/vec.h"

namespace gust {
namespace {

template <class T>
inline constexpr std::size_t kParts = kTileLanes / kVecWidth<T>;  // registers that hold a feature of a tile

/// The elements of a vector added up by halves.
template <class T>
T sum_of(Vec<T> v) {
  for (std::size_t half = kVecWidth<T> / 2; half > 0; half /= 2)
    for (std::size_t i = 0; i < half; ++i) v[i] += v[i + half];
  return v[0];
}

/// Calls f with the activation as a constant.
template <class F>
void with_activation(Activation kind, F&& f) {
  switch (kind) {
    case Activation::kTanh:
      return f.template operator()<Activation::kTanh>();
    case Activation::kRelu:
      return f.template operator()<Activation::kRelu>();
    case Activation::kLeakyRelu:
      return f.template operator()<Activation::kLeakyRelu>();
    case Activation::kIdentity:
      return f.template operator()<Activation::kIdentity>();
  }
}

template <Activation kind, class T>
void activate_all(std::span<const T> bias, T* y) {
  for (const T b : bias) {
    for (std::size_t i = 0; i < kParts<T>; ++i, y += kVecWidth<T>)
      store_as(y, activate<kind, T>(load_as<Vec<T>>(y) + (Vec<T>{} + b)));
  }
}

template <Activation kind, class T>
void through_all(std::span<const T> y, T* dy) {
  for (std::size_t i = 0; i < y.size(); i += kVecWidth<T>)
    store_as(dy + i, through_activation<kind, T>(load_as<Vec<T>>(dy + i), load_as<Vec<T>>(&y[i])));
}

template <Activation kind, class T>
void through_narrow(const NarrowLayer<T>& layer, T* dz) {
  const std::size_t outputs = layer.dy.size() / kTileLanes;
  const std::size_t inputs = layer.y.size() / kTileLanes;
  for (std::size_t k = 0; k < inputs; ++k) {
    Vec<T> sum[kParts<T>] = {};
    for (std::size_t o = 0; o < outputs; ++o) {
      const Vec<T> weight = Vec<T>{} + layer.weights[o * inputs + k];
      unrolled<kParts<T>>([&](std::size_t i) {
        sum[i] = fused(weight, load_as<Vec<T>>(&layer.dy[o * kTileLanes + i * kVecWidth<T>]), sum[i]);
      });
    }
    unrolled<kParts<T>>([&](std::size_t i) {
      const std::size_t at = k * kTileLanes + i * kVecWidth<T>;
      store_as(dz + at, through_activation<kind, T>(sum[i], load_as<Vec<T>>(&layer.y[at])));
    });
  }
}

}  // namespace

template <class T>
void activate_tile(Activation kind, std::span<const T> bias, std::span<T> tile) noexcept {
  with_activation(kind, [&]<Activation known>() { activate_all<known>(bias, tile.data()); });
}

template <class T>
void add_bias_to_tile(std::span<const T> bias, std::span<T> tile) noexcept {
  for (std::size_t feature = 0; feature < bias.size(); ++feature)
    for (std::size_t lane = 0; lane < kTileLanes; ++lane) tile[feature * kTileLanes + lane] += bias[feature];
}

template <class T>
void through_activated_tile(Activation kind, std::span<const T> y, std::span<T> dy) noexcept {
  with_activation(kind, [&]<Activation known>() { through_all<known>(y, dy.data()); });
}

template <class T>
void through_narrow_layer(Activation kind, const NarrowLayer<T>& layer, std::span<T> dz) noexcept {
  with_activation(kind, [&]<Activation known>() { through_narrow<known>(layer, dz.data()); });
}

template <class T>
void add_narrow_gradient(const NarrowLayer<T>& layer, std::span<T> gradient) noexcept {
  const std::size_t outputs = layer.dy.size() / kTileLanes;
  const std::size_t inputs = layer.y.size() / kTileLanes;
  for (std::size_t o = 0; o < outputs; ++o) {
    Vec<T> dy[kParts<T>];
    unrolled<kParts<T>>([&](std::size_t i) { dy[i] = load_as<Vec<T>>(&layer.dy[o * kTileLanes + i * kVecWidth<T>]); });
    for (std::size_t k = 0; k < inputs; ++k) {
      Vec<T> even = {}, odd = {};
      const T* y = &layer.y[k * kTileLanes];
      unrolled<kParts<T>>([&](std::size_t i) {
        Vec<T>& sum = i % 2 == 0 ? even : odd;
        sum = fused(dy[i], load_as<Vec<T>>(y + i * kVecWidth<T>), sum);
      });
      gradient[o * inputs + k] += sum_of<T>(even + odd);
    }
  }
}

template <class T>
void add_lane_sums(std::span<const T> dy, std::span<T> bias) noexcept {
  for (std::size_t o = 0; o < bias.size(); ++o) {
    Vec<T> sum = {};
    for (std::size_t i = 0; i < kParts<T>; ++i) sum += load_as<Vec<T>>(&dy[o * kTileLanes + i * kVecWidth<T>]);
    bias[o] += sum_of<T>(sum);
  }
}

template void activate_tile(Activation, std::span<const float>, std::span<float>) noexcept;
template void activate_tile(Activation, std::span<const double>, std::span<double>) noexcept;
template void add_bias_to_tile(std::span<const float>, std::span<float>) noexcept;
template void add_bias_to_tile(std::span<const double>, std::span<double>) noexcept;
template void through_activated_tile(Activation, std::span<const float>, std::span<float>) noexcept;
template void through_activated_tile(Activation, std::span<const double>, std::span<double>) noexcept;
template void through_narrow_layer(Activation, const NarrowLayer<float>&, std::span<float>) noexcept;
template void through_narrow_layer(Activation, const NarrowLayer<double>&, std::span<double>) noexcept;
template void add_narrow_gradient(const NarrowLayer<float>&, std::span<float>) noexcept;
template void add_narrow_gradient(const NarrowLayer<double>&, std::span<double>) noexcept;
template void add_lane_sums(std::span<const float>, std::span<float>) noexcept;
template void add_lane_sums(std::span<const double>, std::span<double>) noexcept;

}  // namespace gust
