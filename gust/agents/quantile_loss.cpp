#include "gust/agents/quantile_loss.h"

#include <algorithm>

#include "gust/nn/vec.h"

namespace gust {
namespace {

/// One quantile of some lanes, and its fraction in each of them.
template <class V>
struct Quantile {
  V value;
  V fraction;
};

/// Sums over the targets, times kappa.
template <class V>
struct Sums {
  V loss = {};
  V slope = {};  // of the loss by d
};

/// One register of lanes: targets is the first of them, the next 64 lanes further.
template <class T>
Sums<Vec<T>> over_targets(const Quantile<Vec<T>>& quantile, std::span<const T> targets, T kappa) {
  using V = Vec<T>;
  Sums<V> sums;
  for (std::size_t at = 0; at < targets.size(); at += kTileLanes) {
    const V d = load_as<V>(&targets[at]) - quantile.value;
    const V bounded = lesser(V{} + kappa, greater(V{} - kappa, d));
    const V slope = (d < V{} ? T(1) - quantile.fraction : quantile.fraction) * bounded;
    sums.slope += slope;
    sums.loss += slope * (d - T(0.5) * bounded);  // d^2 / 2, or kappa (|d| - kappa / 2)
  }
  return sums;
}

}  // namespace

template <class T>
double quantile_loss(const QuantileSamples<T>& samples, double kappa, Tiles<T>& gradient) noexcept {
  constexpr std::size_t kWidth = kVecWidth<T>;
  const std::size_t lanes = samples.quantiles.lanes();
  const std::size_t count = samples.fractions.count();
  const double share = 1.0 / (kappa * static_cast<double>(lanes * count * samples.targets.features()));
  double loss = 0.0;
  for (std::size_t at = 0; at < samples.quantiles.count() * count * kTileLanes; at += kWidth) {
    const std::size_t tile = at / (count * kTileLanes), i = at / kTileLanes % count, lane = at % kTileLanes;
    const auto& own = samples.fractions.own;
    const Quantile<Vec<T>> quantile = {
        load_as<Vec<T>>(&samples.quantiles.features(tile, i, 1)[lane]),
        own != nullptr ? load_as<Vec<T>>(&own->features(tile, i, 1)[lane]) : Vec<T>{} + samples.fractions.shared[i]};
    const auto sums = over_targets<T>(quantile, samples.targets.tile(tile).subspan(lane), static_cast<T>(kappa));
    const std::size_t first = tile * kTileLanes + lane;
    for (std::size_t k = 0; k < kWidth; ++k) {
      const bool there = first + k < lanes;
      gradient.features(tile, i, 1)[lane + k] = there ? static_cast<T>(-share * static_cast<double>(sums.slope[k])) : 0;
      if (there) loss += static_cast<double>(sums.loss[k]);
    }
  }
  return share * loss;
}

template double quantile_loss(const QuantileSamples<float>&, double, Tiles<float>&) noexcept;
template double quantile_loss(const QuantileSamples<double>&, double, Tiles<double>&) noexcept;

}  // namespace gust
