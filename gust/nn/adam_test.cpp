#include "gust/nn/adam.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace gust;

TEST_CASE("8.1.2 Adam moves one parameter under a constant gradient by -rate g / (|g| + epsilon), every step") {
  const AdamOptions options = {.rate = 1e-3};
  AdamState<double> state(1);
  std::array<double, 1> parameter = {0.25};
  std::array<double, 1> gradient;

  for (int step = 0; step < 100; ++step) {
    const double before = parameter[0];
    gradient[0] = 0.5;
    adam_step<double>(options, state, parameter, gradient);
    CHECK(std::abs((parameter[0] - before) - -9.9999998e-4) < 1e-9);
    if (step == 0) CHECK(std::abs((parameter[0] - before) - -1e-3 * 0.5 / (0.5 + 1e-8)) < 1e-16);
  }

  CHECK(gradient[0] == 0.0);  // consumed
}

TEST_CASE("Adam leaves parameters that never had a gradient alone") {
  AdamState<float> state(3);
  std::array<float, 3> parameters = {0.0f, -2.0f, 0.5f};
  std::array<float, 3> gradient = {};

  adam_step<float>({}, state, parameters, gradient);

  CHECK(parameters == std::array{0.0f, -2.0f, 0.5f});
}

TEST_CASE("gradients of one optimiser are scaled together to the limit of their norm") {
  std::array<float, 2> weights = {3.0f, 0.0f};
  std::array<float, 1> log_std = {4.0f};
  const std::array<std::span<float>, 2> all = {weights, log_std};

  clip_norm<float>(all, 10.0);
  CHECK(weights[0] == 3.0f);
  clip_norm<float>(all, 0.0);
  CHECK(log_std[0] == 4.0f);
  clip_norm<float>(all, 2.5);

  CHECK(weights == std::array{1.5f, 0.0f});
  CHECK(log_std == std::array{2.0f});
}
