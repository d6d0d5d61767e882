#include "gust/nn/quantile_network.h"

#include <algorithm>

#include "gust/core/math.h"
#include "gust/nn/initialise.h"

namespace gust {

MlpShape QuantileShape::trunk() const {
  MlpShape shape{{inputs}, activation};
  shape.sizes.resize(layers + 1, hidden);
  return shape;
}

template <class T>
void initialise_uniform(QuantileNetwork<T>& network, Rng rng) {
  initialise_uniform(network.trunk, rng.split("trunk"));
  initialise_uniform(network.embedding, rng.split("embedding"));
  initialise_uniform(network.top, rng.split("top"));
}

template <class T>
T embedding_cosine(std::size_t i, T fraction) {
  constexpr double kPi = 3.141592653589793238463;
  return static_cast<T>(sin_cos(kPi * static_cast<double>(i) * static_cast<double>(fraction)).cos);
}

template <class T>
QuantileRunner<T>::QuantileRunner(const QuantileShape& shape, const QuantileRoom& room, InputRange wanted)
    : activation_(shape.activation),
      trunk_(shape.trunk(), room.lanes, wanted),
      head_(room.own ? own_quantile_head<T>(shape, room) : shared_quantile_head<T>(shape, room)),
      e_(room.lanes, shape.hidden),
      at_e_(room.lanes, shape.hidden),
      quantiles_(room.lanes, room.fractions),
      no_bias_(shape.hidden) {}

template <class T>
const Tiles<T>& QuantileRunner<T>::forward(const QuantileNetwork<T>& network, const Tiles<T>& input,
                                           const Fractions<T>& fractions) {
  const Tiles<T>& sums = trunk_.forward(network.trunk, input);
  for (std::size_t tile = 0; tile < e_.count(); ++tile) {
    std::ranges::copy(sums.tile(tile), e_.tile(tile).begin());
    activate_tile<T>(activation_, no_bias_, e_.tile(tile));
  }
  head_->forward(network, e_, fractions, quantiles_);
  return quantiles_;
}

template <class T>
void QuantileRunner<T>::back_to_trunk(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles,
                                      QuantileNetwork<T>* gradient) {
  head_->backward(network, at_quantiles, at_e_, gradient);
  for (std::size_t tile = 0; tile < e_.count(); ++tile)
    through_activated_tile<T>(activation_, e_.tile(tile), at_e_.tile(tile));
}

template <class T>
void QuantileRunner<T>::backward(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles,
                                 QuantileNetwork<T>& gradient) {
  back_to_trunk(network, at_quantiles, &gradient);
  trunk_.backward(network.trunk, at_e_, gradient.trunk.parameters());
}

template <class T>
const Tiles<T>& QuantileRunner<T>::backward_to_input(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles) {
  back_to_trunk(network, at_quantiles, nullptr);
  return trunk_.backward_to_input(network.trunk, at_e_);
}

template void initialise_uniform(QuantileNetwork<float>&, Rng);
template void initialise_uniform(QuantileNetwork<double>&, Rng);
template float embedding_cosine(std::size_t, float);
template double embedding_cosine(std::size_t, double);
template class QuantileRunner<float>;
template class QuantileRunner<double>;

}  // namespace gust
