#include "gust/nn/tiled_mlp.h"

#include <algorithm>

#include "gust/nn/transpose.h"

namespace gust {
namespace {

constexpr int kLanes = static_cast<int>(kTileLanes);

}  // namespace

// A tile is a matrix of 64 rows (lanes) without gaps, column after column. A wide layer's weights are a matrix of
// `outputs` rows, a narrow layer's one of `inputs` rows: so one of the two directions takes them as their transpose.
template <class T>
TiledMlp<T>::Layer::Layer(DenseShape shape, std::size_t wanted) : size(shape) {
  const int in = static_cast<int>(size.inputs);
  const int out = static_cast<int>(size.outputs);
  const bool narrow = size.narrow();
  forward = Product<T>({.m = kLanes, .n = out, .k = in, .b_transposed = !narrow});
  const int inputs = narrow || wanted == 0 ? in : static_cast<int>(wanted);
  to_input = Product<T>({.m = kLanes, .n = inputs, .k = out, .b_transposed = narrow});
  if (narrow) return;
  weights[0] = Product<T>({.m = out, .n = in, .k = kLanes});
  weights[1] = Product<T>({.m = out, .n = in, .k = kLanes, .accumulate = true});
}

template <class T>
TiledMlp<T>::TiledMlp(const MlpShape& shape, std::size_t lanes, InputRange wanted) : shape_(shape), wanted_(wanted) {
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    layers_.emplace_back(DenseShape{shape.sizes[layer], shape.sizes[layer + 1]}, layer == 0 ? wanted.count : 0);
    outputs_.emplace_back(lanes, shape.sizes[layer + 1]);
    if (layer + 1 == shape.layers()) continue;
    Tiles<T>& at_sums = at_sums_[layer % 2];
    if (at_sums.features() < shape.sizes[layer + 1]) at_sums = Tiles<T>(lanes, shape.sizes[layer + 1]);
  }
  const bool narrow = layers_.front().size.narrow();
  at_input_ = Tiles<T>(lanes, narrow ? shape.inputs() : wanted.count);
  turned_.resize(kTileLanes * *std::ranges::max_element(shape.sizes));
}

template <class T>
const Tiles<T>& TiledMlp<T>::forward(const Mlp<T>& mlp, const Tiles<T>& input) noexcept {
  input_ = &input;
  const T* parameters = mlp.parameters().data();
  for (std::size_t tile = 0; tile < input.count(); ++tile) {
    for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
      const std::span bias(parameters + mlp.biases_at(layer), shape_.sizes[layer + 1]);
      const std::span<T> y = outputs_[layer].tile(tile);
      layers_[layer].forward(input_of(layer).tile(tile).data(), parameters + mlp.weights_at(layer), y.data());
      activate_tile<T>(shape_.after(layer), bias, y);
    }
  }
  return outputs_.back();
}

template <class T>
std::span<const T> TiledMlp<T>::at_sums(std::size_t layer, std::size_t tile) const {
  const Tiles<T>& all = layer + 1 == layers_.size() ? *at_output_ : at_sums_[layer % 2];
  return all.tile(tile).first(shape_.sizes[layer + 1] * kTileLanes);
}

/// In one tile: the gradient at the sums of the layer below, from that at the sums of a layer.
template <class T>
void TiledMlp<T>::to_layer_below(const Mlp<T>& mlp, std::size_t layer, std::size_t tile) noexcept {
  const DenseShape size = layers_[layer].size;
  const std::span weights(mlp.parameters().data() + mlp.weights_at(layer), size.inputs * size.outputs);
  const std::span<const T> dz = at_sums(layer, tile);
  const std::span<const T> y = outputs_[layer - 1].tile(tile);
  const std::span<T> below = at_sums_[(layer - 1) % 2].tile(tile).first(y.size());
  if (size.narrow()) return through_narrow_layer<T>(shape_.after(layer - 1), {weights, y, dz}, below);
  layers_[layer].to_input(dz.data(), weights.data(), below.data());
  through_activated_tile<T>(shape_.after(layer - 1), y, below);
}

template <class T>
const Tiles<T>& TiledMlp<T>::backward_to_input(const Mlp<T>& mlp, const Tiles<T>& at_output) noexcept {
  begin_backward(at_output);
  const DenseShape size = layers_.front().size;
  const T* weights = mlp.parameters().data() + mlp.weights_at(0) + (size.narrow() ? 0 : wanted_.first * size.outputs);
  for (std::size_t tile = 0; tile < input_->count(); ++tile) {
    for (std::size_t layer = layers_.size() - 1; layer > 0; --layer) to_layer_below(mlp, layer, tile);
    layers_.front().to_input(at_sums(0, tile).data(), weights, at_input_.tile(tile).data());
  }
  return at_input_;
}

template <class T>
void TiledMlp<T>::backward_layer(const Mlp<T>& mlp, std::size_t layer, std::span<T> gradient) noexcept {
  const DenseShape size = layers_[layer].size;
  const std::span weights = gradient.first(size.inputs * size.outputs);
  const std::span bias = gradient.subspan(mlp.biases_at(layer) - mlp.weights_at(layer), size.outputs);
  std::ranges::fill(size.narrow() ? gradient : gradient.subspan(weights.size()), T(0));
  for (std::size_t tile = 0; tile < input_->count(); ++tile) {
    const std::span<const T> dz = at_sums(layer, tile);
    if (layer > 0) to_layer_below(mlp, layer, tile);
    add_lane_sums<T>(dz, bias);
    if (size.narrow()) {
      add_narrow_gradient<T>({{}, input_of(layer).tile(tile), dz}, weights);
    } else {
      transpose(dz.data(), turned_.data(), size.outputs, kTileLanes);
      layers_[layer].weights[tile == 0 ? 0 : 1](turned_.data(), input_of(layer).tile(tile).data(), weights.data());
    }
  }
}

template <class T>
void TiledMlp<T>::backward(const Mlp<T>& mlp, const Tiles<T>& at_output, std::span<T> gradient) noexcept {
  begin_backward(at_output);
  for (std::size_t layer = layers_.size(); layer-- > 0;)
    backward_layer(mlp, layer, gradient.subspan(mlp.weights_at(layer), mlp.parameters_of(layer)));
}

template class TiledMlp<float>;
template class TiledMlp<double>;

}  // namespace gust
