#pragma once

#include <cstddef>
#include <span>

#include "gust/nn/activation.h"
#include "gust/nn/buffer.h"

namespace gust {

inline constexpr std::size_t kTileLanes = 64;

/// A batch in tiles of 64 lanes: tile after tile, in a tile feature after feature, and of a feature its 64 lanes side
/// by side. So a linear layer, its transpose and a bias all run along the lanes without turning the weights. The last
/// tile may have lanes beyond the batch; they are computed like the others, and whoever fills in gradients leaves them
/// zero.
template <class T>
class Tiles {
 public:
  Tiles() = default;
  /// All zeros.
  Tiles(std::size_t lanes, std::size_t features)
      : lanes_(lanes),
        features_(features),
        data_((lanes + kTileLanes - 1) / kTileLanes * kTileLanes * features, T(0)) {}

  std::size_t lanes() const { return lanes_; }
  std::size_t features() const { return features_; }
  std::size_t count() const { return (lanes_ + kTileLanes - 1) / kTileLanes; }

  /// All features of a tile: features x 64.
  std::span<T> tile(std::size_t index) { return {data_.data() + index * size(), size()}; }
  std::span<const T> tile(std::size_t index) const { return {data_.data() + index * size(), size()}; }

  /// Some features of a tile.
  std::span<T> features(std::size_t index, std::size_t first, std::size_t count) {
    return tile(index).subspan(first * kTileLanes, count * kTileLanes);
  }
  std::span<const T> features(std::size_t index, std::size_t first, std::size_t count) const {
    return tile(index).subspan(first * kTileLanes, count * kTileLanes);
  }

  T& at(std::size_t lane, std::size_t feature) { return data_[index_of(lane, feature)]; }
  const T& at(std::size_t lane, std::size_t feature) const { return data_[index_of(lane, feature)]; }

 private:
  std::size_t size() const { return features_ * kTileLanes; }
  std::size_t index_of(std::size_t lane, std::size_t feature) const {
    return lane / kTileLanes * size() + feature * kTileLanes + lane % kTileLanes;
  }

  std::size_t lanes_ = 0;
  std::size_t features_ = 0;
  Buffer<T> data_;
};

/// What a layer's sums become in one tile: tile = activate(tile + bias), bias one number a feature.
template <class T>
void activate_tile(Activation kind, std::span<const T> bias, std::span<T> tile) noexcept;

/// tile = tile + bias.
template <class T>
void add_bias_to_tile(std::span<const T> bias, std::span<T> tile) noexcept;

/// Turns the gradient dy at activations y into the gradient at their sums, in place.
template <class T>
void through_activated_tile(Activation kind, std::span<const T> y, std::span<T> dy) noexcept;

/// A layer of few outputs above the activations y of a tile (inputs x 64), with the gradient dy (outputs x 64) at its
/// sums. Weights lie output by output.
template <class T>
struct NarrowLayer {
  std::span<const T> weights;
  std::span<const T> y;
  std::span<const T> dy;
};

/// The gradient at the sums below, through the activation: dz_k = y'_k sum over o of weights[o][k] dy_o.
template <class T>
void through_narrow_layer(Activation kind, const NarrowLayer<T>& layer, std::span<T> dz) noexcept;

/// gradient[o][k] += sum over the lanes of dy_o y_k: 8 (float) or 4 (double) sums in turn, added up by halves.
template <class T>
void add_narrow_gradient(const NarrowLayer<T>& layer, std::span<T> gradient) noexcept;

/// bias[o] += sum of the 64 lanes of feature o.
template <class T>
void add_lane_sums(std::span<const T> dy, std::span<T> bias) noexcept;

}  // namespace gust
