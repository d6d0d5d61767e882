#include "gust/nn/adam.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

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

TEST_CASE("8.4.4 what follows a constant source is off by (1 - share) to the number of steps") {
  std::vector<float> source(20, 1.0f), gradient(20), target(20);
  std::vector<double> exact_source(20, 1.0), exact_gradient(20), exact_target(20);
  AdamState<float> state(20);
  AdamState<double> exact_state(20);
  for (int step = 0; step < 1000; ++step) {
    adam_move<float>({{}, state}, {source, gradient, state.first, state.second}, {target, 0.005f});
    adam_move<double>({{}, exact_state}, {exact_source, exact_gradient, exact_state.first, exact_state.second},
                      {exact_target, 0.005});
  }

  CHECK(source == std::vector<float>(20, 1.0f));
  for (int i = 0; i < 20; ++i) {
    CHECK(std::abs(1.0 - exact_target[i] - 0.0066540) < 1e-7);
    CHECK(std::abs(1.0 - exact_target[i] - std::pow(0.995, 1000)) < 1e-12);
    CHECK(std::abs(1.0 - target[i] - 0.0066540) < 2e-5);  // float32 rounds a thousand times
  }
}

TEST_CASE("a step in parts, with a target network, moves the parameters as a whole step does") {
  constexpr std::size_t kCount = 50;
  std::vector<float> whole(kCount), parts(kCount), target(kCount, 0.5f);
  std::vector<float> gradient(kCount), same_gradient(kCount);
  AdamState<float> whole_state(kCount), parts_state(kCount);
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = 0; i < kCount; ++i) gradient[i] = same_gradient[i] = 0.1f * static_cast<float>(i) - 2.0f;
    adam_step<float>({}, whole_state, whole, gradient);
    const AdamStep<float> step({}, parts_state);
    const std::vector<float> before = target;
    for (const std::size_t first : {20u, 0u}) {
      const std::size_t count = first == 0 ? 20 : kCount - 20;
      const auto part = [&](auto& all) { return std::span(all).subspan(first, count); };
      adam_move<float>(step, {part(parts), part(same_gradient), part(parts_state.first), part(parts_state.second)},
                       {part(target), 0.25f});
    }
    for (std::size_t i = 0; i < kCount; ++i)
      CHECK(target[i] == doctest::Approx(0.75f * before[i] + 0.25f * parts[i]).epsilon(1e-6));
  }

  CHECK(parts == whole);
}
