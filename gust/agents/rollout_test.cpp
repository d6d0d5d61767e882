#include "gust/agents/rollout.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "gust/core/rng.h"

using namespace gust;

namespace {

enum class End { kNone, kTerminated, kTruncated };

/// Three steps of one environment: rewards 1, values 0.5, the episode perhaps ending at step 1.
Rollout three_steps(End end) {
  Rollout rollout(1, 3, 1, 1);
  rollout.reward = {1.0, 1.0, 1.0};
  rollout.value = {0.5f, 0.5f, 0.5f};
  rollout.last_value = {0.5};
  rollout.done = {0, end != End::kNone, 0};
  if (end == End::kTruncated) {
    rollout.truncated = {1};
    rollout.terminal_value = {2.0};
  }
  return rollout;
}

ReturnOptions gae(double lambda) { return {.discount = 0.9, .lambda = lambda, .use_gae = true}; }

bool near(const std::vector<double>& values, std::array<double, 3> expected) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(values[i] - expected[i]) > 1e-12) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("8.2.1 advantages and returns of three steps have the values worked out by hand") {
  Rollout going = three_steps(End::kNone);
  Rollout terminated = three_steps(End::kTerminated);
  Rollout truncated = three_steps(End::kTruncated);

  for (Rollout* rollout : {&going, &terminated, &truncated}) estimate_returns(gae(0.8), *rollout);

  CHECK(near(going.advantage, {2.12648, 1.634, 0.95}));
  CHECK(near(going.value_target, {3.0745, 2.305, 1.45}));
  CHECK(near(terminated.advantage, {1.31, 0.5, 0.95}));
  CHECK(near(terminated.value_target, {1.9, 1.0, 1.45}));
  CHECK(near(truncated.advantage, {2.606, 2.3, 0.95}));
  CHECK(near(truncated.value_target, {3.52, 2.8, 1.45}));
}

TEST_CASE("8.2.1 with lambda 1 the estimated advantage is return minus value") {
  for (const End end : {End::kNone, End::kTerminated, End::kTruncated}) {
    Rollout estimated = three_steps(end);
    Rollout plain = three_steps(end);

    estimate_returns(gae(1.0), estimated);
    estimate_returns({.discount = 0.9, .use_gae = false}, plain);

    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(std::abs(estimated.advantage[i] - plain.advantage[i]) < 1e-12);
      CHECK(std::abs(plain.advantage[i] - (plain.value_target[i] - 0.5)) < 1e-12);
    }
  }
}

TEST_CASE("8.2.1 standardised advantages have mean 0 and deviation s / (s + 1e-6)") {
  std::vector<double> values(400);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 7.0 + 1e-4 * Rng(1).normal(i);
  const auto moments = [&] {
    double mean = 0.0, square = 0.0;
    for (const double value : values) mean += value / 400.0;
    for (const double value : values) square += (value - mean) * (value - mean) / 400.0;
    return std::array{mean, std::sqrt(square)};
  };
  const double spread = moments()[1];

  standardise(values);

  CHECK(std::abs(moments()[0]) < 1e-6);
  CHECK(moments()[1] == doctest::Approx(spread / (spread + 1e-6)).epsilon(1e-9));
}

TEST_CASE("the value target can be advantage plus value") {
  Rollout rollout = three_steps(End::kNone);

  estimate_returns({.discount = 0.9, .lambda = 0.8, .use_gae = true, .td_lambda_target = true}, rollout);

  CHECK(near(rollout.value_target, {2.62648, 2.134, 1.45}));
}

TEST_CASE("8.5.1 an opponent has the same steps with the rewards negated, and its own actions") {
  Rollout rollout = three_steps(End::kTruncated), opponent(1, 3, 1, 2);
  rollout.terminal_observation.push_back(7.0f);
  rollout.observation = {1.0f, 2.0f, 3.0f};
  opponent.action = {1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f};

  oppose(rollout, opponent);

  CHECK(opponent.reward == std::vector<double>{-1.0, -1.0, -1.0});
  CHECK(std::ranges::equal(opponent.observation, rollout.observation));
  CHECK(opponent.done == rollout.done);
  CHECK(opponent.truncated == rollout.truncated);
  CHECK(opponent.terminal_observation.front() == 7.0f);
  CHECK(opponent.action[5] == 6.0f);
}

TEST_CASE("environments of a rollout do not mix") {
  Rollout rollout(2, 2, 1, 1);
  rollout.reward = {1.0, 10.0, 1.0, 10.0};  // step 0 of both, then step 1
  rollout.last_value = {0.0, 100.0};

  estimate_returns({.discount = 0.5}, rollout);

  CHECK(rollout.value_target == std::vector<double>{1.5, 40.0, 1.0, 60.0});
}
