#include "gust/nn/tiles.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/core/rng.h"

using namespace gust;

namespace {

template <class T>
std::vector<T> draws(std::size_t count, std::uint64_t seed) {
  std::vector<T> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<T>(Rng(seed).normal(i));
  return values;
}

constexpr Activation kAll[] = {Activation::kTanh, Activation::kRelu, Activation::kLeakyRelu};

}  // namespace

TEST_CASE("lanes beyond the batch fill the last tile") {
  Tiles<float> tiles(65, 3);

  tiles.at(64, 2) = 5.0f;

  CHECK(tiles.count() == 2);
  CHECK(tiles.tile(1).size() == 3 * kTileLanes);
  CHECK(tiles.features(1, 2, 1)[0] == 5.0f);
  CHECK(tiles.tile(0)[2 * kTileLanes] == 0.0f);
}

TEST_CASE_TEMPLATE("layers in tiles are activated and gone back through as lanes by themselves are", T, float, double) {
  constexpr std::size_t kFeatures = 3;
  for (const Activation activation : kAll) {
    const auto bias = draws<T>(kFeatures, 1), dy = draws<T>(kFeatures * kTileLanes, 2);
    auto tile = draws<T>(kFeatures * kTileLanes, 3), slope = dy;
    auto lanes = std::vector<T>(tile.size()), lane_slope = lanes, unused = std::vector<T>(kFeatures);
    const auto turned = [](std::size_t i) { return i % kTileLanes * kFeatures + i / kTileLanes; };
    for (std::size_t i = 0; i < tile.size(); ++i) {
      lanes[turned(i)] = tile[i];
      lane_slope[turned(i)] = dy[i];
    }

    activate_tile<T>(activation, bias, tile);
    through_activated_tile<T>(activation, tile, slope);
    add_bias_and_activate<T>(activation, bias, lanes);
    through_activations<T>(activation, lanes, lane_slope, unused);

    for (std::size_t i = 0; i < tile.size(); ++i) {
      CHECK(tile[i] == lanes[turned(i)]);
      CHECK(slope[i] == lane_slope[turned(i)]);
    }
  }
}

TEST_CASE_TEMPLATE("a layer of few outputs sends gradients down and collects its own", T, float, double) {
  constexpr std::size_t kInputs = 5, kOutputs = 2;
  const auto weights = draws<T>(kInputs * kOutputs, 1), y = draws<T>(kInputs * kTileLanes, 2);
  const auto dy = draws<T>(kOutputs * kTileLanes, 3);
  std::vector<T> dz(y.size()), gradient(weights.size(), T(1)), bias(kOutputs, T(1));

  through_narrow_layer<T>(Activation::kRelu, {weights, y, dy}, dz);
  add_narrow_gradient<T>({weights, y, dy}, gradient);
  add_lane_sums<T>(dy, bias);

  const double tolerance = sizeof(T) == sizeof(float) ? 1e-5 : 1e-13;
  for (std::size_t k = 0; k < kInputs; ++k) {
    for (std::size_t lane = 0; lane < kTileLanes; ++lane) {
      double expected = 0.0;
      for (std::size_t o = 0; o < kOutputs; ++o) expected += weights[o * kInputs + k] * dy[o * kTileLanes + lane];
      if (y[k * kTileLanes + lane] <= 0) expected = 0.0;
      CHECK(std::abs(dz[k * kTileLanes + lane] - expected) < tolerance);
    }
  }
  for (std::size_t o = 0; o < kOutputs; ++o) {
    double sum = 1.0;
    for (std::size_t lane = 0; lane < kTileLanes; ++lane) sum += dy[o * kTileLanes + lane];
    CHECK(std::abs(bias[o] - sum) < tolerance);
    for (std::size_t k = 0; k < kInputs; ++k) {
      double expected = 1.0;
      for (std::size_t lane = 0; lane < kTileLanes; ++lane)
        expected += double{dy[o * kTileLanes + lane]} * y[k * kTileLanes + lane];
      CHECK(std::abs(gradient[o * kInputs + k] - expected) < 10 * tolerance);
    }
  }
}
