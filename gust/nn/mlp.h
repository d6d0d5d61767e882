#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "gust/nn/activation.h"
#include "gust/nn/buffer.h"
#include "gust/nn/dense.h"

namespace gust {

/// A chain of linear layers with an activation after every one but the last; `linear_top` leaves it out after the last
/// hidden layer, too.
struct MlpShape {
  std::vector<std::size_t> sizes;  ///< inputs, hidden widths, outputs
  Activation activation = Activation::kTanh;
  bool linear_top = false;

  std::size_t inputs() const { return sizes.front(); }
  std::size_t outputs() const { return sizes.back(); }
  std::size_t layers() const { return sizes.size() - 1; }
  /// What a layer's sums go through, counted from 0.
  Activation after(std::size_t layer) const {
    return layer + (linear_top ? 2 : 1) < layers() ? activation : Activation::kIdentity;
  }
  friend bool operator==(const MlpShape&, const MlpShape&) = default;
};

/// A network: its shape and all its parameters in one flat buffer.
///
/// Layer after layer, weights then biases, each starting on a cache line; the gaps hold zeros and stay zero under
/// every optimiser that moves a parameter along its gradient.
template <class T>
class Mlp {
 public:
  Mlp() = default;

  /// All parameters zero.
  explicit Mlp(MlpShape shape);

  const MlpShape& shape() const { return shape_; }
  std::span<T> parameters() { return parameters_; }
  std::span<const T> parameters() const { return parameters_; }

  T& weight(std::size_t layer, std::size_t output, std::size_t input) {
    return parameters_[weights_at(layer) + index(layer, output, input)];
  }
  T weight(std::size_t layer, std::size_t output, std::size_t input) const {
    return parameters_[weights_at(layer) + index(layer, output, input)];
  }
  T& bias(std::size_t layer, std::size_t output) { return parameters_[biases_at(layer) + output]; }
  T bias(std::size_t layer, std::size_t output) const { return parameters_[biases_at(layer) + output]; }

  /// Where a layer's weights and biases start in the buffer.
  std::size_t weights_at(std::size_t layer) const { return starts_[2 * layer]; }
  std::size_t biases_at(std::size_t layer) const { return starts_[2 * layer + 1]; }
  /// How many numbers of the buffer belong to a layer, the gaps included.
  std::size_t parameters_of(std::size_t layer) const {
    return (layer + 1 < shape_.layers() ? weights_at(layer + 1) : parameters_.size()) - weights_at(layer);
  }

 private:
  std::size_t index(std::size_t layer, std::size_t output, std::size_t input) const {
    return DenseShape{shape_.sizes[layer], shape_.sizes[layer + 1]}.index(output, input);
  }

  MlpShape shape_;
  std::vector<std::size_t> starts_;
  Buffer<T> parameters_;
};

/// The same network in another precision.
template <class To, class From>
Mlp<To> converted(const Mlp<From>& mlp) {
  Mlp<To> result(mlp.shape());
  for (std::size_t i = 0; i < mlp.parameters().size(); ++i)
    result.parameters()[i] = static_cast<To>(mlp.parameters()[i]);
  return result;
}

/// The same map without the hidden layer that `linear_top` leaves linear: the two layers about it are one, their
/// product formed in double. A network without one is returned as it is.
Mlp<float> without_linear_top(const Mlp<float>& mlp);

/// What running a network of one shape needs besides its parameters: compiled products and memory for up to max_lanes
/// lanes. One thread at a time; no call but the constructor allocates.
///
/// A batch is lanes x features, the features of a lane side by side. The bits of a lane depend on no other lane and
/// not on their number.
template <class T>
class MlpWorkspace {
 public:
  MlpWorkspace(const MlpShape& shape, std::size_t max_lanes);

  std::size_t max_lanes() const { return max_lanes_; }

  /// The outputs (lanes x outputs) for a batch of inputs (lanes x inputs). Input and result are kept for backward: the
  /// caller leaves the input as it is until then; the result holds until the next forward.
  std::span<const T> forward(const Mlp<T>& mlp, std::span<const T> input) noexcept;

  /// Adds onto `gradient`, laid out as the parameters, the gradient of a loss whose gradient at the outputs of the last
  /// forward is given. Each element adds up in the order of the lanes.
  void backward(const Mlp<T>& mlp, std::span<const T> output_gradient, std::span<T> gradient) noexcept;

  /// Writes the gradient at the inputs (lanes x inputs) of the last forward, and nothing else.
  void backward_to_input(const Mlp<T>& mlp, std::span<const T> output_gradient, std::span<T> gradient) noexcept;

 private:
  struct Lanes {
    std::size_t first;
    std::size_t count;
  };
  struct Gradients {
    T* parameters = nullptr;  // the whole buffer, added onto; or
    T* input = nullptr;       // lanes x inputs, overwritten
  };

  struct Step {
    const T* dz;  // at the sums of the upper layer
    T* below;     // at those of the lower one, to be written
    T* sums;      // gradient of all parameters
  };

  void forward_block(const Mlp<T>& mlp, Lanes lanes) noexcept;
  void backward_block(const Mlp<T>& mlp, Lanes lanes, const T* dz, Gradients gradients) noexcept;
  void backward_all(const Mlp<T>& mlp, std::span<const T> output_gradient, Gradients gradients) noexcept;
  void below_single_output(const Mlp<T>& mlp, Lanes lanes, Step step) noexcept;
  std::span<const T> activations(std::size_t layer, Lanes lanes) const;
  const T* input_of(std::size_t layer, std::size_t lane) const;

  static constexpr std::size_t kBlock = 64;  // lanes that pass all layers together, to stay in the near caches

  MlpShape shape_;
  std::size_t max_lanes_;
  std::size_t lanes_ = 0;
  const T* input_ = nullptr;
  std::vector<Dense<T>> layers_;
  std::vector<Buffer<T>> outputs_;          // of each layer, after its activation
  std::vector<Buffer<T>> transposed_;       // weights of each layer, where it needs them
  std::vector<const T*> output_major_;      // weights of each layer during a backward pass
  std::array<Buffer<T>, 2> sum_gradients_;  // at the sums of two layers in turn
  Buffer<T> unused_gradient_;
};

}  // namespace gust
