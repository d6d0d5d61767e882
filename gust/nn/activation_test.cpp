#include "gust/nn/activation.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/rng.h"

using namespace gust;

namespace {

float tanh_of(float x) { return activate<Activation::kTanh, float>(x); }

}  // namespace

TEST_CASE("tanh in float is within 1e-6 of the true value over all floats") {
  double largest = 0.0;
  float beyond = 0.0f;

  for (std::uint32_t bits = 0; bits < 0x7f800000u; bits += 199) {  // every 199th float from zero to infinity
    const float x = std::bit_cast<float>(bits);
    const float y = tanh_of(x);
    largest = std::max(largest, std::abs(static_cast<double>(y) - std::tanh(static_cast<double>(x))));
    beyond = std::max(beyond, y);
  }

  CHECK(largest < 5e-7);
  CHECK(beyond <= 1.0f);
  CHECK(tanh_of(std::numeric_limits<float>::infinity()) == doctest::Approx(1.0));
  CHECK(std::isnan(tanh_of(std::numeric_limits<float>::quiet_NaN())));
}

TEST_CASE("tanh is odd to the bit") {
  for (const float x : {0.0f, 1e-30f, 1e-3f, 0.3f, 2.0f, 7.95f, 100.0f}) CHECK(tanh_of(-x) == -tanh_of(x));
}

TEST_CASE("tanh in double is the true one to the last digits") {
  for (double x = -25.0; x < 25.0; x += 0.00317) {
    const double y = activate<Activation::kTanh, double>(x);
    CHECK(std::abs(y - std::tanh(x)) < 3e-16);
  }
}

TEST_CASE("a whole vector and its tail get the bits of single numbers") {
  constexpr std::size_t kWidth = 13;
  std::vector<float> bias(kWidth), y(3 * kWidth), one;
  for (std::size_t i = 0; i < kWidth; ++i) bias[i] = static_cast<float>(Rng(1).normal(i));
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = static_cast<float>(4.0 * Rng(2).normal(i));
  for (std::size_t i = 0; i < y.size(); ++i) one.push_back(tanh_of(y[i] + bias[i % kWidth]));

  add_bias_and_activate<float>(Activation::kTanh, bias, y);

  CHECK(y == one);
}

TEST_CASE("relu and leaky relu cut and bend at zero") {
  const std::vector<float> bias = {1.0f, 1.0f};
  std::vector<float> y = {-3.0f, 1.0f};
  std::vector<float> leaky = y;

  add_bias_and_activate<float>(Activation::kRelu, bias, y);
  add_bias_and_activate<float>(Activation::kLeakyRelu, bias, leaky);

  CHECK(y == std::vector<float>{0.0f, 2.0f});
  CHECK(leaky == std::vector<float>{-0.02f, 2.0f});
}

TEST_CASE("the gradient passes the activation and its columns add up") {
  const std::vector<float> y = {0.5f, -0.5f, 0.0f, 1.0f};
  std::vector<float> dy = {1.0f, 2.0f, 4.0f, 8.0f};
  std::vector<float> sums = {100.0f, 0.0f};

  through_activations<float>(Activation::kTanh, y, dy, sums);

  CHECK(dy == std::vector<float>{0.75f, 1.5f, 4.0f, 0.0f});
  CHECK(sums == std::vector<float>{104.75f, 1.5f});
}
