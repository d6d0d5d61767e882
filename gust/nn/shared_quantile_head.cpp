#include <algorithm>

#include "gust/core/error.h"
#include "gust/nn/quantile_network.h"
#include "gust/nn/transpose.h"
#include "gust/nn/vec.h"

namespace gust {
namespace {

constexpr int kLanes = static_cast<int>(kTileLanes);
constexpr std::size_t kGroup = 4;  // fractions that one product takes together

/// Every row of a matrix times the same row, element by element.
template <class T>
void scale_columns(std::span<const T> matrix, const T* factors, std::size_t columns, T* to) {
  for (std::size_t start = 0; start < matrix.size(); start += columns)
    for (std::size_t i = 0; i < columns; ++i) to[start + i] = factors[i] * matrix[start + i];
}

/// The gradients of W and of psi from outer = sum over the lanes of dh e^T at one fraction, all head x hidden or
/// hidden.
template <class T>
struct Collected {
  const T* outer;
  const T* weights;
  const T* psi;
  T* at_weights;  // added onto: psi * outer
  T* at_psi;      // written: sum over the head of weights * outer
};

/// kCount times V columns of it, from the column `first` on.
template <class V, std::size_t kCount, class T>
void collect_columns(const Collected<T>& c, std::size_t first, std::size_t head, std::size_t hidden) {
  constexpr std::size_t kWidth = sizeof(V) / sizeof(T);
  V psi[kCount], sum[kCount];
  unrolled<kCount>([&](std::size_t i) {
    psi[i] = load_as<V>(c.psi + first + i * kWidth);
    sum[i] = V{};
  });
  for (std::size_t row = 0; row < head; ++row) {
    unrolled<kCount>([&](std::size_t i) {
      const std::size_t at = row * hidden + first + i * kWidth;
      const V outer = load_as<V>(c.outer + at);
      sum[i] = fused(load_as<V>(c.weights + at), outer, sum[i]);
      store_as(c.at_weights + at, fused(psi[i], outer, load_as<V>(c.at_weights + at)));
    });
  }
  unrolled<kCount>([&](std::size_t i) { store_as(c.at_psi + first + i * kWidth, sum[i]); });
}

template <class T>
void collect(const Collected<T>& c, std::size_t head, std::size_t hidden) {
  constexpr std::size_t kWidth = kVecWidth<T>;
  std::size_t j = 0;
  for (; j + 4 * kWidth <= hidden; j += 4 * kWidth) collect_columns<Vec<T>, 4>(c, j, head, hidden);
  for (; j + kWidth <= hidden; j += kWidth) collect_columns<Vec<T>, 1>(c, j, head, hidden);
  for (; j < hidden; ++j) collect_columns<T, 1>(c, j, head, hidden);
}

/// The products of a tile for so many fractions together. The head's sums of a group are (fraction, unit) x 64 lanes,
/// its weights (fraction, unit) x hidden.
template <class T>
struct GroupProducts {
  Product<T> forward;   // sums from e
  Product<T> backward;  // adds onto the gradient at e
  Product<T> outer;     // gradient at the sums times e turned, of the first tile
  Product<T> add_outer;

  GroupProducts(std::size_t fractions, const QuantileShape& shape) {
    const int units = static_cast<int>(fractions * shape.head);
    const int hidden = static_cast<int>(shape.hidden);
    forward = Product<T>({.m = kLanes, .n = units, .k = hidden});
    backward = Product<T>({.m = kLanes, .n = hidden, .k = units, .b_transposed = true, .accumulate = true});
    outer = Product<T>({.m = hidden, .n = units, .k = kLanes});
    add_outer = Product<T>({.m = hidden, .n = units, .k = kLanes, .accumulate = true});
  }
};

template <class T>
class SharedQuantileHead final : public QuantileHead<T> {
 public:
  SharedQuantileHead(const QuantileShape& shape, const QuantileRoom& room);

  void forward(const QuantileNetwork<T>& network, const Tiles<T>& e, const Fractions<T>& fractions,
               Tiles<T>& quantiles) override;
  void backward(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles, Tiles<T>& at_e,
                QuantileNetwork<T>* gradient) override;

 private:
  struct Group {
    std::size_t first;
    std::size_t count;
  };

  /// Calls f for whole groups, then for what is left one by one.
  template <class F>
  void for_each_group(F&& f) const {
    std::size_t first = 0;
    for (; first + kGroup <= room_.fractions; first += kGroup) f(Group{first, kGroup});
    for (; first < room_.fractions; ++first) f(Group{first, 1});
  }
  const GroupProducts<T>& products(const Group& group) const { return group.count == kGroup ? whole_ : single_; }
  std::span<T> units(std::size_t tile, std::size_t fraction) {
    const std::size_t size = shape_.head * kTileLanes;
    return std::span(units_).subspan((tile * room_.fractions + fraction) * size, size);
  }
  std::span<T> at_units(std::size_t index) {
    return std::span(at_units_).subspan(index * shape_.head * kTileLanes, shape_.head * kTileLanes);
  }

  void embed(const QuantileNetwork<T>& network, std::span<const T> fractions);
  void weigh(const Group& group);
  void through_top(const QuantileNetwork<T>& network, std::span<const T> y, std::span<const T> at_quantile,
                   std::span<T> at_units, QuantileNetwork<T>* gradient);
  void collect_group(const Group& group);
  void finish_gradient(const QuantileNetwork<T>& network, QuantileNetwork<T>& gradient);

  QuantileShape shape_;
  QuantileRoom room_;
  GroupProducts<T> whole_;
  GroupProducts<T> single_;
  Product<T> output_;  // from the units of a fraction to its quantile
  MlpWorkspace<T> embedding_;

  const Tiles<T>* e_ = nullptr;
  Buffer<T> cosines_;       // fractions x cosines
  Buffer<T> psi_, at_psi_;  // fractions x hidden
  Buffer<T> no_bias_, unused_bias_;
  Buffer<T> weights_, at_weights_;  // of top's first layer, output by output
  Buffer<T> group_weights_;         // (fraction, unit) x hidden
  Buffer<T> outer_;                 // the same
  Buffer<T> units_;                 // tile by tile, fractions x head x 64, activated
  Buffer<T> at_units_;              // of a group of a tile
  Buffer<T> turned_;                // e, tile by tile, the numbers of a lane side by side
};

template <class T>
SharedQuantileHead<T>::SharedQuantileHead(const QuantileShape& shape, const QuantileRoom& room)
    : shape_(shape),
      room_(room),
      whole_(kGroup, shape),
      single_(1, shape),
      output_({.m = kLanes, .n = 1, .k = static_cast<int>(shape.head)}),
      embedding_(shape.embedding(), room.fractions) {
  const std::size_t tiles = Tiles<T>(room.lanes, 0).count();
  const std::size_t size = shape.hidden * shape.head;
  cosines_.resize(room.fractions * shape.cosines);
  psi_.resize(room.fractions * shape.hidden);
  at_psi_.resize(psi_.size());
  no_bias_.resize(shape.hidden);
  unused_bias_.resize(shape.hidden);
  weights_.resize(size);
  at_weights_.resize(size);
  group_weights_.resize(kGroup * size);
  outer_.resize(kGroup * size);
  units_.resize(tiles * room.fractions * shape.head * kTileLanes);
  at_units_.resize(kGroup * shape.head * kTileLanes);
  turned_.resize(tiles * shape.hidden * kTileLanes);
}

template <class T>
void SharedQuantileHead<T>::embed(const QuantileNetwork<T>& network, std::span<const T> fractions) {
  GUST_CHECK(fractions.size() == room_.fractions);
  for (std::size_t row = 0; row < fractions.size(); ++row)
    for (std::size_t i = 0; i < shape_.cosines; ++i)
      cosines_[row * shape_.cosines + i] = embedding_cosine(i, fractions[row]);
  std::ranges::copy(embedding_.forward(network.embedding, cosines_), psi_.begin());
  add_bias_and_activate<T>(shape_.activation, no_bias_, psi_);
}

/// The weights of a group: those of top's first layer times psi.
template <class T>
void SharedQuantileHead<T>::weigh(const Group& group) {
  for (std::size_t i = 0; i < group.count; ++i)
    scale_columns<T>(weights_, &psi_[(group.first + i) * shape_.hidden], shape_.hidden,
                     &group_weights_[i * weights_.size()]);
}

template <class T>
void SharedQuantileHead<T>::forward(const QuantileNetwork<T>& network, const Tiles<T>& e, const Fractions<T>& fractions,
                                    Tiles<T>& quantiles) {
  e_ = &e;
  embed(network, fractions.shared);
  const Mlp<T>& top = network.top;
  const bool narrow = DenseShape{shape_.hidden, shape_.head}.narrow();
  narrow ? void(std::copy_n(top.parameters().data(), weights_.size(), weights_.data()))
         : transpose(top.parameters().data(), weights_.data(), shape_.hidden, shape_.head);
  const std::span bias = top.parameters().subspan(top.biases_at(0), shape_.head);
  const std::span last_bias = top.parameters().subspan(top.biases_at(1), 1);
  for_each_group([&](const Group& group) {
    weigh(group);
    for (std::size_t tile = 0; tile < e.count(); ++tile) {
      products(group).forward(e.tile(tile).data(), group_weights_.data(), units(tile, group.first).data());
      for (std::size_t i = group.first; i < group.first + group.count; ++i) {
        const std::span<T> quantile = quantiles.features(tile, i, 1);
        activate_tile<T>(shape_.activation, bias, units(tile, i));
        output_(units(tile, i).data(), &top.parameters()[top.weights_at(1)], quantile.data());
        add_bias_to_tile<T>(last_bias, quantile);
      }
    }
  });
}

template <class T>
void SharedQuantileHead<T>::backward(const QuantileNetwork<T>& network, const Tiles<T>& at_quantiles, Tiles<T>& at_e,
                                     QuantileNetwork<T>* gradient) {
  const std::size_t tile_size = shape_.hidden * kTileLanes;
  std::ranges::fill(at_weights_, T(0));
  if (gradient != nullptr) std::ranges::fill(gradient->top.parameters(), T(0));
  for (std::size_t tile = 0; tile < e_->count(); ++tile) {
    std::ranges::fill(at_e.tile(tile), T(0));
    if (gradient != nullptr) transpose(e_->tile(tile).data(), &turned_[tile * tile_size], shape_.hidden, kTileLanes);
  }
  for_each_group([&](const Group& group) {
    weigh(group);
    for (std::size_t tile = 0; tile < e_->count(); ++tile) {
      for (std::size_t i = 0; i < group.count; ++i)
        through_top(network, units(tile, group.first + i), at_quantiles.features(tile, group.first + i, 1), at_units(i),
                    gradient);
      products(group).backward(at_units_.data(), group_weights_.data(), at_e.tile(tile).data());
      if (gradient == nullptr) continue;
      const Product<T>& outer = tile == 0 ? products(group).outer : products(group).add_outer;
      outer(&turned_[tile * tile_size], at_units_.data(), outer_.data());
    }
    if (gradient != nullptr) collect_group(group);
  });
  if (gradient != nullptr) finish_gradient(network, *gradient);
}

/// From the gradient at a quantile to that at the sums of its units; adds the gradients of what lies between.
template <class T>
void SharedQuantileHead<T>::through_top(const QuantileNetwork<T>& network, std::span<const T> y,
                                        std::span<const T> at_quantile, std::span<T> at_units,
                                        QuantileNetwork<T>* gradient) {
  const Mlp<T>& top = network.top;
  const NarrowLayer<T> layer = {top.parameters().subspan(top.weights_at(1), shape_.head), y, at_quantile};
  through_narrow_layer<T>(shape_.activation, layer, at_units);
  if (gradient == nullptr) return;
  const std::span all = gradient->top.parameters();
  add_narrow_gradient<T>(layer, all.subspan(top.weights_at(1), shape_.head));
  add_lane_sums<T>(at_quantile, all.subspan(top.biases_at(1), 1));
  add_lane_sums<T>(at_units, all.subspan(top.biases_at(0), shape_.head));
}

template <class T>
void SharedQuantileHead<T>::collect_group(const Group& group) {
  for (std::size_t i = 0; i < group.count; ++i) {
    const std::size_t row = (group.first + i) * shape_.hidden;
    collect<T>({&outer_[i * weights_.size()], weights_.data(), &psi_[row], at_weights_.data(), &at_psi_[row]},
               shape_.head, shape_.hidden);
  }
}

template <class T>
void SharedQuantileHead<T>::finish_gradient(const QuantileNetwork<T>& network, QuantileNetwork<T>& gradient) {
  const bool narrow = DenseShape{shape_.hidden, shape_.head}.narrow();
  T* to = gradient.top.parameters().data();
  narrow ? void(std::ranges::copy(at_weights_, to)) : transpose(at_weights_.data(), to, shape_.head, shape_.hidden);
  through_activations<T>(shape_.activation, psi_, at_psi_, unused_bias_);
  std::ranges::fill(gradient.embedding.parameters(), T(0));
  embedding_.backward(network.embedding, at_psi_, gradient.embedding.parameters());
}

}  // namespace

template <class T>
std::unique_ptr<QuantileHead<T>> shared_quantile_head(const QuantileShape& shape, const QuantileRoom& room) {
  return std::make_unique<SharedQuantileHead<T>>(shape, room);
}

template std::unique_ptr<QuantileHead<float>> shared_quantile_head(const QuantileShape&, const QuantileRoom&);
template std::unique_ptr<QuantileHead<double>> shared_quantile_head(const QuantileShape&, const QuantileRoom&);

}  // namespace gust
