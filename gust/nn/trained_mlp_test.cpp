#include "gust/nn/trained_mlp.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/core/rng.h"
#include "gust/nn/initialise.h"

using namespace gust;

namespace {

const MlpShape kShape{{3, 20, 24, 2}, Activation::kRelu};
constexpr std::size_t kLanes = 70;

Tiles<double> draws(std::size_t features, std::uint64_t seed) {
  Tiles<double> tiles(kLanes, features);
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    for (std::size_t i = 0; i < features; ++i) tiles.at(lane, i) = Rng(seed).normal(lane * features + i);
  return tiles;
}

TrainedMlp<double> drawn_network() {
  TrainedMlp<double> network(kShape, kLanes, {}, TrainedMlp<double>::Target::kYes);
  initialise_uniform(network.mlp(), Rng(2));
  network.start();
  return network;
}

}  // namespace

TEST_CASE("a step layer by layer is a step of Adam along the whole gradient, and the copy follows") {
  TrainedMlp<double> network = drawn_network();
  Mlp<double> plain = network.mlp();
  TiledMlp<double> tiled(kShape, kLanes);
  AdamState<double> adam(plain.parameters().size());
  Buffer<double> gradient(plain.parameters().size());
  const Tiles<double> input = draws(3, 5), at_output = draws(2, 6);
  for (int step = 0; step < 5; ++step) {
    const Mlp<double> target = network.target();
    network.forward(input);
    network.step({}, at_output, 0.25);
    tiled.forward(plain, input);
    tiled.backward(plain, at_output, gradient);
    adam_step<double>({}, adam, plain.parameters(), gradient);

    CHECK(std::ranges::equal(network.mlp().parameters(), plain.parameters()));
    for (std::size_t i = 0; i < plain.parameters().size(); ++i) {
      const double expected = 0.75 * target.parameters()[i] + 0.25 * plain.parameters()[i];
      CHECK(std::abs(network.target().parameters()[i] - expected) < 1e-15);
    }
  }
}

TEST_CASE("NaN in a network is found") {
  TrainedMlp<double> network = drawn_network();
  CHECK(network.finite());
  network.mlp().bias(1, 3) = NAN;
  CHECK_FALSE(network.finite());
}
