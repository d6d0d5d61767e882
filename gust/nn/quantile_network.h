#pragma once

#include <array>
#include <memory>
#include <span>

#include "gust/core/rng.h"
#include "gust/nn/tiled_mlp.h"

namespace gust {

/// Size of an implicit quantile network.
struct QuantileShape {
  std::size_t inputs;
  std::size_t hidden = 256;  ///< width of the trunk's layers, and of the embedding
  std::size_t layers = 2;    ///< of the trunk
  std::size_t cosines = 16;
  std::size_t head = 32;
  Activation activation = Activation::kRelu;

  MlpShape trunk() const;
  MlpShape embedding() const { return {{cosines, hidden}, activation}; }
  MlpShape top() const { return {{hidden, head, 1}, activation}; }
};

/// A law of returns by its quantiles (Dabney et al. 2018; docs/algorithms.md 5.1): Z(x; tau) = top(e(x) * psi(tau)),
/// element by element, with e = f(trunk(x)), psi = f(embedding(cos(pi i tau))), i = 0 … cosines - 1, and the activation
/// f.
template <class T>
struct QuantileNetwork {
  QuantileNetwork() = default;
  explicit QuantileNetwork(const QuantileShape& shape)
      : trunk(shape.trunk()), embedding(shape.embedding()), top(shape.top()) {}

  Mlp<T> trunk;
  Mlp<T> embedding;
  Mlp<T> top;

  /// All parameters, part by part.
  std::array<std::span<T>, 3> parameters() { return {trunk.parameters(), embedding.parameters(), top.parameters()}; }
  std::array<std::span<const T>, 3> parameters() const {
    return {trunk.parameters(), embedding.parameters(), top.parameters()};
  }
};

/// Weights and biases of every layer from U(-b, b), b = 1 / sqrt(inputs of the layer).
template <class T>
void initialise_uniform(QuantileNetwork<T>& network, Rng rng);

/// The fractions tau at which quantiles are asked: a set for all lanes, or each lane's own.
template <class T>
struct Fractions {
  std::span<const T> shared;
  const Tiles<T>* own = nullptr;  ///< lanes x fractions; `shared` is empty then

  std::size_t count() const { return own != nullptr ? own->features() : shared.size(); }
};

/// cos(pi i fraction).
template <class T>
T embedding_cosine(std::size_t i, T fraction);

/// What lies above the trunk: from e and fractions to quantiles, and back.
template <class T>
class QuantileHead {
 public:
  virtual ~QuantileHead() = default;

  /// Fills quantiles (lanes x fractions) from e. All arguments are left as they are until backward.
  virtual void forward(const QuantileNetwork<T>& network, const Tiles<T>& e, const Fractions<T>& fractions,
                       Tiles<T>& quantiles) = 0;

  /// From the gradient at the quantiles: writes that at e, and if `gradient` is there, those of embedding and top.
  virtual void backward(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles, Tiles<T>& at_e,
                        QuantileNetwork<T>* gradient) = 0;
};

/// Size of a batch.
struct QuantileRoom {
  std::size_t lanes = 0;
  std::size_t fractions = 0;
  bool own = false;  ///< whether each lane has its own
};

/// A head for fractions that all lanes share. The first layer of top and psi become one linear layer on e, whose
/// weights are W * psi(tau_i) for every fraction i: forward and backward are products of that layer, and no lanes x
/// fractions x hidden numbers are ever formed.
template <class T>
std::unique_ptr<QuantileHead<T>> shared_quantile_head(const QuantileShape& shape, const QuantileRoom& room);

/// A head for fractions of each lane's own, as the network is defined; it takes about half as long again.
template <class T>
std::unique_ptr<QuantileHead<T>> own_quantile_head(const QuantileShape& shape, const QuantileRoom& room);

/// Runs a quantile network over batches of `room.lanes` lanes. One thread at a time; no call but the constructor
/// allocates.
template <class T>
class QuantileRunner {
 public:
  using InputRange = typename TiledMlp<T>::InputRange;

  /// `wanted`: the inputs whose gradient backward_to_input gives.
  QuantileRunner(const QuantileShape& shape, const QuantileRoom& room, InputRange wanted);

  /// The quantiles, lanes x fractions. Arguments stay as they are until the way back; the result holds until the next
  /// forward.
  const Tiles<T>& forward(const QuantileNetwork<T>& network, const Tiles<T>& input, const Fractions<T>& fractions);

  /// Writes the gradient of all parameters, from that at the quantiles of the last forward.
  void backward(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles, QuantileNetwork<T>& gradient);

  /// The gradient at the wanted inputs (the last features of the result) of the last forward.
  const Tiles<T>& backward_to_input(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles);

 private:
  void back_to_trunk(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles, QuantileNetwork<T>* gradient);

  Activation activation_;
  TiledMlp<T> trunk_;
  std::unique_ptr<QuantileHead<T>> head_;
  Tiles<T> e_, at_e_;
  Tiles<T> quantiles_;
  Buffer<T> no_bias_;
};

}  // namespace gust
