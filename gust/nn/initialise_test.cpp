#include "gust/nn/initialise.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace gust;

TEST_CASE("8.1.3 initial weights and biases lie within 1 / sqrt(fan in), with the variance of the uniform law") {
  Mlp<float> mlp({{256, 256, 3}});
  double square = 0.0;
  bool inside = true;

  initialise_uniform(mlp, Rng(11));

  for (std::size_t output = 0; output < 256; ++output) {
    for (std::size_t input = 0; input < 256; ++input) {
      const double w = mlp.weight(0, output, input);
      inside = inside && std::abs(w) <= 1.0 / 16.0;
      square += w * w;
    }
    inside = inside && std::abs(mlp.bias(0, output)) <= 1.0 / 16.0 && mlp.bias(0, output) != 0.0f;
  }
  CHECK(inside);
  CHECK(square / (256.0 * 256.0) == doctest::Approx(1.0 / (3.0 * 256.0)).epsilon(0.02));
}

TEST_CASE("equal streams start equal networks, other streams others") {
  Mlp<float> a({{4, 64, 1}}), b({{4, 64, 1}}), c({{4, 64, 1}});

  initialise_uniform(a, Rng(1));
  initialise_uniform(b, Rng(1));
  initialise_uniform(c, Rng(2));

  CHECK(std::ranges::equal(a.parameters(), b.parameters()));
  CHECK_FALSE(std::ranges::equal(a.parameters(), c.parameters()));
}

TEST_CASE("orthogonal weights keep lengths up to their gain, and biases are zero") {
  Mlp<double> mlp({{4, 64, 32, 2}});

  initialise_orthogonal(mlp, {.hidden = 1.5, .output = 0.01}, Rng(5));

  for (std::size_t layer = 0; layer < 3; ++layer) {
    const std::size_t inputs = mlp.shape().sizes[layer];
    const std::size_t outputs = mlp.shape().sizes[layer + 1];
    const double gain = layer == 2 ? 0.01 : 1.5;
    const bool tall = outputs > inputs;
    for (std::size_t i = 0; i < std::min(inputs, outputs); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double overlap = 0.0;
        for (std::size_t k = 0; k < std::max(inputs, outputs); ++k)
          overlap += tall ? mlp.weight(layer, k, i) * mlp.weight(layer, k, j)
                          : mlp.weight(layer, i, k) * mlp.weight(layer, j, k);
        CHECK(std::abs(overlap - (i == j ? gain * gain : 0.0)) < 1e-13);
      }
    }
    CHECK(mlp.bias(layer, 0) == 0.0);
  }
}
