#include "gust/nn/mlp.h"

#include <algorithm>

#include "gust/core/error.h"

namespace gust {
namespace {

constexpr std::size_t kLine = 16;  // elements; a cache line of floats

std::size_t on_line(std::size_t count) { return (count + kLine - 1) / kLine * kLine; }

}  // namespace

template <class T>
Mlp<T>::Mlp(MlpShape shape) : shape_(std::move(shape)) {
  GUST_CHECK(shape_.sizes.size() >= 2);
  GUST_CHECK(std::ranges::all_of(shape_.sizes, [](std::size_t size) { return size > 0; }));
  std::size_t size = 0;
  for (std::size_t layer = 0; layer < shape_.layers(); ++layer) {
    starts_.push_back(size);
    size += on_line(shape_.sizes[layer] * shape_.sizes[layer + 1]);
    starts_.push_back(size);
    size += on_line(shape_.sizes[layer + 1]);
  }
  parameters_.assign(size, T(0));
}

template <class T>
MlpWorkspace<T>::MlpWorkspace(const MlpShape& shape, std::size_t max_lanes) : shape_(shape), max_lanes_(max_lanes) {
  const std::size_t widest = *std::ranges::max_element(shape.sizes);
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    const DenseShape size = {shape.sizes[layer], shape.sizes[layer + 1]};
    layers_.emplace_back(size);
    outputs_.emplace_back(max_lanes * size.outputs);
    transposed_.emplace_back(size.narrow() ? 0 : size.inputs * size.outputs);
  }
  output_major_.resize(shape.layers());
  for (Buffer<T>& gradient : sum_gradients_) gradient.resize(std::min(kBlock, max_lanes) * widest);
  unused_gradient_.resize(Mlp<T>(shape).parameters().size());
}

template <class T>
const T* MlpWorkspace<T>::input_of(std::size_t layer, std::size_t lane) const {
  return (layer == 0 ? input_ : outputs_[layer - 1].data()) + lane * shape_.sizes[layer];
}

template <class T>
std::span<const T> MlpWorkspace<T>::forward(const Mlp<T>& mlp, std::span<const T> input) noexcept {
  input_ = input.data();
  lanes_ = input.size() / shape_.inputs();
  for (std::size_t lane = 0; lane < lanes_; lane += kBlock) forward_block(mlp, {lane, std::min(kBlock, lanes_ - lane)});
  return {outputs_.back().data(), lanes_ * shape_.outputs()};
}

template <class T>
void MlpWorkspace<T>::forward_block(const Mlp<T>& mlp, Lanes lanes) noexcept {
  const T* parameters = mlp.parameters().data();
  for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
    const std::size_t width = shape_.sizes[layer + 1];
    const std::span y(outputs_[layer].data() + lanes.first * width, lanes.count * width);
    const std::span bias(parameters + mlp.biases_at(layer), width);
    layers_[layer].forward(parameters + mlp.weights_at(layer), input_of(layer, lanes.first), y.data(), lanes.count);
    add_bias_and_activate(shape_.after(layer), bias, y);
  }
}

template <class T>
void MlpWorkspace<T>::backward(const Mlp<T>& mlp, std::span<const T> output_gradient, std::span<T> gradient) noexcept {
  backward_all(mlp, output_gradient, {.parameters = gradient.data()});
}

template <class T>
void MlpWorkspace<T>::backward_to_input(const Mlp<T>& mlp, std::span<const T> output_gradient,
                                        std::span<T> gradient) noexcept {
  backward_all(mlp, output_gradient, {.input = gradient.data()});
}

template <class T>
void MlpWorkspace<T>::backward_all(const Mlp<T>& mlp, std::span<const T> output_gradient,
                                   Gradients gradients) noexcept {
  for (std::size_t layer = gradients.input != nullptr ? 0 : 1; layer < layers_.size(); ++layer) {
    const T* weights = mlp.parameters().data() + mlp.weights_at(layer);
    output_major_[layer] = layers_[layer].output_major(weights, transposed_[layer].data());
  }
  for (std::size_t lane = 0; lane < lanes_; lane += kBlock) {
    const Lanes lanes = {lane, std::min(kBlock, lanes_ - lane)};
    const std::span dy = output_gradient.subspan(lane * shape_.outputs(), lanes.count * shape_.outputs());
    if (gradients.parameters != nullptr)
      add_columns(dy, std::span(gradients.parameters + mlp.biases_at(layers_.size() - 1), shape_.outputs()));
    backward_block(mlp, lanes, dy.data(), gradients);
  }
}

template <class T>
void MlpWorkspace<T>::backward_block(const Mlp<T>& mlp, Lanes lanes, const T* dz, Gradients gradients) noexcept {
  T* sums = gradients.parameters != nullptr ? gradients.parameters : unused_gradient_.data();
  for (std::size_t layer = layers_.size(); layer-- > 0;) {
    T* below = sum_gradients_[layer % 2].data();
    if (layer > 0 && shape_.sizes[layer + 1] == 1) {
      below_single_output(mlp, lanes, {dz, below, sums});
    } else {
      if (gradients.parameters != nullptr)
        layers_[layer].add_weight_gradient(input_of(layer, lanes.first), dz, sums + mlp.weights_at(layer), lanes.count);
      if (layer == 0) break;
      layers_[layer].input_gradient(output_major_[layer], dz, below, lanes.count);
      through_activations(shape_.after(layer - 1), activations(layer - 1, lanes),
                          std::span(below, lanes.count * shape_.sizes[layer]),
                          std::span(sums + mlp.biases_at(layer - 1), shape_.sizes[layer]));
    }
    dz = below;
  }
  if (gradients.input != nullptr)
    layers_[0].input_gradient(output_major_[0], dz, gradients.input + lanes.first * shape_.inputs(), lanes.count);
}

/// The last layer and the activations below it in one pass.
template <class T>
void MlpWorkspace<T>::below_single_output(const Mlp<T>& mlp, Lanes lanes, Step step) noexcept {
  const std::size_t layer = layers_.size() - 1;
  const std::size_t width = shape_.sizes[layer];
  const SingleOutput<T> output = {mlp.parameters().subspan(mlp.weights_at(layer), width),
                                  {step.dz, lanes.count},
                                  {step.sums + mlp.weights_at(layer), width}};
  through_single_output(shape_.after(layer - 1), activations(layer - 1, lanes), output,
                        {{step.below, lanes.count * width}, {step.sums + mlp.biases_at(layer - 1), width}});
}

template <class T>
std::span<const T> MlpWorkspace<T>::activations(std::size_t layer, Lanes lanes) const {
  const std::size_t width = shape_.sizes[layer + 1];
  return std::span(outputs_[layer]).subspan(lanes.first * width, lanes.count * width);
}

Mlp<float> without_linear_top(const Mlp<float>& mlp) {
  MlpShape shape = mlp.shape();
  if (!shape.linear_top || shape.layers() < 2) return mlp;
  const std::size_t upper = shape.layers() - 1;
  const std::size_t hidden = shape.sizes[upper];
  shape.sizes.erase(shape.sizes.end() - 2);
  shape.linear_top = false;
  Mlp<float> result(shape);
  for (std::size_t layer = 0; layer + 1 < upper; ++layer)
    std::ranges::copy(mlp.parameters().subspan(mlp.weights_at(layer), mlp.parameters_of(layer)),
                      result.parameters().begin() + static_cast<std::ptrdiff_t>(result.weights_at(layer)));
  const auto joined = [&](std::size_t output, double sum, auto&& lower) {
    for (std::size_t k = 0; k < hidden; ++k) sum += static_cast<double>(mlp.weight(upper, output, k)) * lower(k);
    return static_cast<float>(sum);
  };
  for (std::size_t output = 0; output < shape.outputs(); ++output) {
    result.bias(upper - 1, output) =
        joined(output, mlp.bias(upper, output), [&](std::size_t k) -> double { return mlp.bias(upper - 1, k); });
    for (std::size_t input = 0; input < shape.sizes[upper - 1]; ++input)
      result.weight(upper - 1, output, input) =
          joined(output, 0.0, [&](std::size_t k) -> double { return mlp.weight(upper - 1, k, input); });
  }
  return result;
}

template class Mlp<float>;
template class Mlp<double>;
template class MlpWorkspace<float>;
template class MlpWorkspace<double>;

}  // namespace gust
