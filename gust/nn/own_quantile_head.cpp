#include <algorithm>
#include <functional>

#include "gust/core/error.h"
#include "gust/nn/quantile_network.h"

namespace gust {
namespace {

/// Lanes and fractions become lanes of longer batches: the tiles of fraction 0, those of fraction 1, and so on.
template <class T>
class OwnQuantileHead final : public QuantileHead<T> {
 public:
  OwnQuantileHead(const QuantileShape& shape, const QuantileRoom& room)
      : shape_(shape),
        lanes_(Tiles<T>(room.lanes, 0).count() * kTileLanes * room.fractions),
        embedding_(shape.embedding(), lanes_),
        top_(shape.top(), lanes_, {.first = 0, .count = shape.hidden}),
        cosines_(lanes_, shape.cosines),
        psi_(lanes_, shape.hidden),
        at_psi_(lanes_, shape.hidden),
        product_(lanes_, shape.hidden),
        at_output_(lanes_, 1),
        no_bias_(shape.hidden) {}

  void forward(const QuantileNetwork<T>& network, const Tiles<T>& e, const Fractions<T>& fractions,
               Tiles<T>& quantiles) override;
  void backward(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles, Tiles<T>& at_e,
                QuantileNetwork<T>* gradient) override;

 private:
  void embed(const QuantileNetwork<T>& network, const Tiles<T>& fractions);

  QuantileShape shape_;
  std::size_t lanes_;
  TiledMlp<T> embedding_;
  TiledMlp<T> top_;
  const Tiles<T>* e_ = nullptr;
  Tiles<T> cosines_, psi_, at_psi_, product_, at_output_;
  Buffer<T> no_bias_;
};

template <class T>
void OwnQuantileHead<T>::embed(const QuantileNetwork<T>& network, const Tiles<T>& fractions) {
  const std::size_t tiles = fractions.count();
  GUST_CHECK(fractions.features() * tiles == psi_.count());
  for (std::size_t at = 0; at < psi_.count(); ++at) {
    const std::span<const T> fraction = fractions.features(at % tiles, at / tiles, 1);
    const std::span<T> cosines = cosines_.tile(at);
    for (std::size_t i = 0; i < cosines.size(); ++i)
      cosines[i] = embedding_cosine(i / kTileLanes, fraction[i % kTileLanes]);
  }
  const Tiles<T>& sums = embedding_.forward(network.embedding, cosines_);
  for (std::size_t at = 0; at < psi_.count(); ++at) {
    std::ranges::copy(sums.tile(at), psi_.tile(at).begin());
    activate_tile<T>(shape_.activation, no_bias_, psi_.tile(at));
  }
}

template <class T>
void OwnQuantileHead<T>::forward(const QuantileNetwork<T>& network, const Tiles<T>& e, const Fractions<T>& fractions,
                                 Tiles<T>& quantiles) {
  e_ = &e;
  embed(network, *fractions.own);
  for (std::size_t at = 0; at < psi_.count(); ++at)
    std::ranges::transform(psi_.tile(at), e.tile(at % e.count()), product_.tile(at).begin(), std::multiplies<>());
  const Tiles<T>& output = top_.forward(network.top, product_);
  for (std::size_t at = 0; at < psi_.count(); ++at)
    std::ranges::copy(output.tile(at), quantiles.features(at % e.count(), at / e.count(), 1).begin());
}

template <class T>
void OwnQuantileHead<T>::backward(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles, Tiles<T>& at_e,
                                  QuantileNetwork<T>* gradient) {
  const std::size_t tiles = e_->count();
  for (std::size_t at = 0; at < psi_.count(); ++at)
    std::ranges::copy(at_quantiles.features(at % tiles, at / tiles, 1), at_output_.tile(at).begin());
  if (gradient != nullptr) top_.backward(network.top, at_output_, gradient->top.parameters());
  const Tiles<T>& at_product = top_.backward_to_input(network.top, at_output_);
  for (std::size_t tile = 0; tile < tiles; ++tile) std::ranges::fill(at_e.tile(tile), T(0));
  for (std::size_t at = 0; at < psi_.count(); ++at) {
    const std::span<const T> slope = at_product.tile(at), e = e_->tile(at % tiles), psi = psi_.tile(at);
    const std::span<T> to_e = at_e.tile(at % tiles), to_psi = at_psi_.tile(at);
    for (std::size_t i = 0; i < slope.size(); ++i) {
      to_e[i] += slope[i] * psi[i];
      to_psi[i] = slope[i] * e[i];
    }
    through_activated_tile<T>(shape_.activation, psi, to_psi);
  }
  if (gradient != nullptr) embedding_.backward(network.embedding, at_psi_, gradient->embedding.parameters());
}

}  // namespace

template <class T>
std::unique_ptr<QuantileHead<T>> own_quantile_head(const QuantileShape& shape, const QuantileRoom& room) {
  return std::make_unique<OwnQuantileHead<T>>(shape, room);
}

template std::unique_ptr<QuantileHead<float>> own_quantile_head(const QuantileShape&, const QuantileRoom&);
template std::unique_ptr<QuantileHead<double>> own_quantile_head(const QuantileShape&, const QuantileRoom&);

}  // namespace gust
