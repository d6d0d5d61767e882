#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "gust/nn/mlp.h"
#include "gust/nn/product.h"
#include "gust/nn/tiles.h"

namespace gust {

/// Runs a network over batches in tiles: for networks so wide, or batches so steady, that products are what takes time.
/// MlpWorkspace is its equal for any number of lanes, to the same bits in wide layers. What training needs is kept
/// apart, so that it is paid for only where it is asked for:
///
///   forward, backward_to_input                   a network that others learn through
///   forward, begin_backward, backward_layer ...  one that learns, each layer's gradient consumed while it is near
///
/// One thread at a time; no call but the constructor allocates.
template <class T>
class TiledMlp {
 public:
  /// Inputs whose gradient backward_to_input gives.
  struct InputRange {
    std::size_t first = 0;
    std::size_t count = 0;
  };

  TiledMlp(const MlpShape& shape, std::size_t lanes, InputRange wanted);
  TiledMlp(const MlpShape& shape, std::size_t lanes) : TiledMlp(shape, lanes, {}) {}

  const MlpShape& shape() const { return shape_; }

  /// The outputs of a batch of inputs. Both are kept for the way back: the caller leaves the input as it is until then;
  /// the result holds until the next forward.
  const Tiles<T>& forward(const Mlp<T>& mlp, const Tiles<T>& input) noexcept;

  /// The gradient at the wanted inputs of the last forward, from that at its outputs; holds until the next call. (A
  /// first layer of at most 16 outputs gives all inputs.)
  const Tiles<T>& backward_to_input(const Mlp<T>& mlp, const Tiles<T>& at_output) noexcept;

  /// Starts the way back from the gradient at the outputs of the last forward, which is left as it is until layer 0.
  void begin_backward(const Tiles<T>& at_output) noexcept { at_output_ = &at_output; }

  /// Writes the gradient of one layer's parameters, laid out as they lie in the network: weights, gap, biases, gap;
  /// zeros in the gaps. To be called from the last layer to the first; the layer's parameters may change after it.
  void backward_layer(const Mlp<T>& mlp, std::size_t layer, std::span<T> gradient) noexcept;

  /// All of them: the gradient of all parameters.
  void backward(const Mlp<T>& mlp, const Tiles<T>& at_output, std::span<T> gradient) noexcept;

 private:
  struct Layer {
    Layer(DenseShape size, std::size_t wanted);

    DenseShape size;
    Product<T> forward;
    Product<T> to_input;                // all inputs, or the wanted ones of the first layer
    std::array<Product<T>, 2> weights;  // the first tile, and the others onto it
  };

  const Tiles<T>& input_of(std::size_t layer) const { return layer == 0 ? *input_ : outputs_[layer - 1]; }
  std::span<const T> at_sums(std::size_t layer, std::size_t tile) const;
  void to_layer_below(const Mlp<T>& mlp, std::size_t layer, std::size_t tile) noexcept;

  MlpShape shape_;
  InputRange wanted_;
  const Tiles<T>* input_ = nullptr;
  const Tiles<T>* at_output_ = nullptr;
  std::vector<Layer> layers_;
  std::vector<Tiles<T>> outputs_;    // of each layer, after its activation
  std::array<Tiles<T>, 2> at_sums_;  // gradients at the sums of even and of odd layers
  Tiles<T> at_input_;
  Buffer<T> turned_;  // a tile of at_sums_, the features of a lane side by side
};

}  // namespace gust
