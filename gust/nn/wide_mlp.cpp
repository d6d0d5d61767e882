#include "gust/nn/wide_mlp.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "gust/core/error.h"
#include "gust/nn/vec.h"

namespace gust {
namespace {

using V = Vec<double>;
using Bits = std::int64_t __attribute__((vector_size(32)));
constexpr std::size_t kWidth = kVecWidth<double>;

/// tanh x = p / (p + 2) with p = e^2x - 1 = 2^n (2^f - 1) + (2^n - 1), where 2x / ln 2 = n + f with |f| <= 1/2.
/// (2^f - 1) / f is the polynomial through its values at the seven Chebyshev nodes, within 2.7e-10.
[[gnu::always_inline]] inline V tanh_of(V x) {
  constexpr double kEnd = 20.0;  // beyond, it is one to the last bit
  constexpr double kTwoOverLn2 = 2.8853900817779268;
  constexpr double kRound = 0x1.8p52;
  const V t = lesser(V{} + kEnd, greater(V{} - kEnd, x)) * kTwoOverLn2;
  const V shifted = t + kRound;
  const V f = t - (shifted - kRound);
  V g = fused(f, V{} + 1.52973237607024e-05, V{} + 0.0001546144469856913);
  g = fused(g, f, V{} + 0.0013333502386162766);
  g = fused(g, f, V{} + 0.009618056678524637);
  g = fused(g, f, V{} + 0.055504108839096185);
  g = fused(g, f, V{} + 0.24022650922288757);
  g = fused(g, f, V{} + 0.6931471805599453);
  const V scale = std::bit_cast<V>(std::bit_cast<Bits>(V{} + 1.0) + (std::bit_cast<Bits>(shifted) << 52));
  const V p = fused(scale, g * f, scale - 1.0);
  return p / (p + 2.0);
}

template <Activation kind>
void activate_all(std::span<double> y) {
  for (std::size_t i = 0; i < y.size(); i += kWidth) {
    const V z = load_as<V>(&y[i]);
    if constexpr (kind == Activation::kTanh) {
      store_as(&y[i], tanh_of(z));
    } else {
      store_as(&y[i], activate<kind, double>(z));
    }
  }
}

void activate_all(Activation kind, std::span<double> y) {
  switch (kind) {
    case Activation::kTanh:
      return activate_all<Activation::kTanh>(y);
    case Activation::kRelu:
      return activate_all<Activation::kRelu>(y);
    case Activation::kLeakyRelu:
      return activate_all<Activation::kLeakyRelu>(y);
    case Activation::kIdentity:
      return;
  }
}

/// What a tile reads and writes: weights and y begin at its first column, x and y at its first lane.
struct TileAt {
  const double* weights;
  const double* bias;
  const double* x;
  double* y;
};
struct TileStep {
  std::size_t inputs;
  std::size_t columns;  ///< from an input's weights to the next, and from a lane of y to the next
  std::size_t x;        ///< from a lane of x to the next
};

/// kLanes lanes times kVecs registers of outputs, held in registers: one chain of fused multiply-adds an output, in the
/// order of the inputs, that starts at the bias. Unrolled, or the compiler would keep the sums in memory.
template <int kLanes, int kVecs>
void tile(const TileAt& at, const TileStep& step) {
  V sum[kLanes][kVecs];
#pragma GCC unroll 8
  for (int v = 0; v < kVecs; ++v) {
#pragma GCC unroll 8
    for (int lane = 0; lane < kLanes; ++lane) sum[lane][v] = load_as<V>(at.bias + v * kWidth);
  }
  for (std::size_t k = 0; k < step.inputs; ++k) {
    V x[kLanes];
#pragma GCC unroll 8
    for (int lane = 0; lane < kLanes; ++lane) x[lane] = _mm256_set1_pd(at.x[lane * step.x + k]);
#pragma GCC unroll 8
    for (int v = 0; v < kVecs; ++v) {
      const V w = load_as<V>(at.weights + k * step.columns + v * kWidth);
#pragma GCC unroll 8
      for (int lane = 0; lane < kLanes; ++lane) sum[lane][v] = fused(x[lane], w, sum[lane][v]);
    }
  }
#pragma GCC unroll 8
  for (int lane = 0; lane < kLanes; ++lane) {
#pragma GCC unroll 8
    for (int v = 0; v < kVecs; ++v) store_as(at.y + lane * step.columns + v * kWidth, sum[lane][v]);
  }
}

/// All lanes of kVecs registers of outputs.
template <int kLanes, int kVecs>
void strip(TileAt at, const TileStep& step, std::size_t lanes) {
  std::size_t lane = 0;
  for (; lane + kLanes <= lanes; lane += kLanes) {
    tile<kLanes, kVecs>(at, step);
    at.x += kLanes * step.x;
    at.y += kLanes * step.columns;
  }
  for (; lane < lanes; ++lane) {
    tile<1, kVecs>(at, step);
    at.x += step.x;
    at.y += step.columns;
  }
}

}  // namespace

WideMlp::WideMlp(const Mlp<float>& mlp, std::size_t max_lanes) {
  const MlpShape& shape = mlp.shape();
  std::size_t widest = 0;
  for (std::size_t i = 0; i < shape.layers(); ++i) {
    Layer layer{.inputs = shape.sizes[i],
                .outputs = shape.sizes[i + 1],
                .stride = (shape.sizes[i + 1] + kWidth - 1) / kWidth * kWidth,
                .activation = shape.after(i),
                .weights = {},
                .biases = {}};
    layer.weights.assign(layer.inputs * layer.stride, 0.0);
    layer.biases.assign(layer.stride, 0.0);
    for (std::size_t output = 0; output < layer.outputs; ++output) {
      layer.biases[output] = static_cast<double>(mlp.bias(i, output));
      for (std::size_t input = 0; input < layer.inputs; ++input) {
        layer.weights[input * layer.stride + output] = static_cast<double>(mlp.weight(i, output, input));
      }
    }
    widest = std::max(widest, layer.stride);
    layers_.push_back(std::move(layer));
  }
  for (Buffer<double>& buffer : buffers_) buffer.assign(max_lanes * widest, 0.0);
  result_.resize(max_lanes * shape.outputs());
}

std::span<const double> WideMlp::forward(std::span<const double> in) noexcept {
  const std::size_t lanes = in.size() / inputs();
  const double* x = in.data();
  std::size_t x_stride = inputs();
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const std::span<double> y(buffers_[i % 2].data(), lanes * layers_[i].stride);
    multiply(layers_[i], {x, x_stride}, y);
    activate_all(layers_[i].activation, y);
    x = y.data();
    x_stride = layers_[i].stride;
  }
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    std::copy_n(x + lane * x_stride, outputs(), result_.data() + lane * outputs());
  }
  return {result_.data(), lanes * outputs()};
}

void WideMlp::multiply(const Layer& layer, const Batch& x, std::span<double> y) noexcept {
  const std::size_t lanes = y.size() / layer.stride;
  const TileStep step{layer.inputs, layer.stride, x.stride};
  std::size_t column = 0;
  const auto at = [&] {
    return TileAt{layer.weights.data() + column, layer.biases.data() + column, x.data, y.data() + column};
  };
  for (; column + 4 * kWidth <= layer.stride; column += 4 * kWidth) strip<3, 4>(at(), step, lanes);
  for (; column < layer.stride; column += kWidth) strip<8, 1>(at(), step, lanes);
}

}  // namespace gust
