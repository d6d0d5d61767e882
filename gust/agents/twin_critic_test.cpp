#include "gust/agents/twin_critic.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace gust;

namespace {

constexpr TransitionShape kShape{.observations = 2, .actions = 1};
constexpr std::size_t kLanes = 70;

OffPolicyOptions small() { return {.hidden = 32, .discount = 0.25, .batch = kLanes, .polyak = 0.25}; }

Minibatch drawn_batch() {
  Minibatch batch(kShape, kLanes);
  std::uint64_t draw = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    for (Tiles<float>* tiles : {&batch.taken, &batch.acted, &batch.next_acted})
      for (std::size_t i = 0; i < 3; ++i) tiles->at(lane, i) = static_cast<float>(Rng(3).normal(draw++));
    batch.reward[lane] = static_cast<float>(lane % 5);
    batch.alive[lane] = lane % 3 == 0 ? 0.0f : 1.0f;
  }
  return batch;
}

/// Values of one critic, copied.
std::vector<double> values(TwinCritic& critic, std::size_t which, const Tiles<float>& input) {
  const Tiles<float>& output = critic.values(which, input);
  std::vector<double> result;
  for (std::size_t lane = 0; lane < kLanes; ++lane) result.push_back(output.at(lane, 0));
  return result;
}

}  // namespace

TEST_CASE("critics are judged by the lesser of the two, and so is the slope at the actions") {
  TwinCritic critic(small(), kShape, Rng(1));
  Minibatch batch = drawn_batch();
  std::vector<float> value(kLanes);
  Tiles<float> slope(kLanes, 1);

  critic.judge(batch.acted, Rng(0), {value, slope});

  const auto first = values(critic, 0, batch.acted), second = values(critic, 1, batch.acted);
  int lesser = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    CHECK(value[lane] == std::min(first[lane], second[lane]));
    lesser += first[lane] < second[lane] ? 1 : 0;
  }
  CHECK(lesser > 0);
  CHECK(lesser < static_cast<int>(kLanes));
  constexpr float kStep = 1e-2f;
  std::vector<float> above(kLanes), below(kLanes);
  Tiles<float> unused(kLanes, 1);
  for (std::size_t lane = 0; lane < kLanes; ++lane) batch.acted.at(lane, 2) += kStep;
  critic.judge(batch.acted, Rng(0), {above, unused});
  for (std::size_t lane = 0; lane < kLanes; ++lane) batch.acted.at(lane, 2) -= 2 * kStep;
  critic.judge(batch.acted, Rng(0), {below, unused});
  int close = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    close += std::abs((above[lane] - below[lane]) / (2 * kStep) - slope.at(lane, 0)) < 2e-3 ? 1 : 0;
  CHECK(close > static_cast<int>(kLanes) * 8 / 10);  // a kink of a ReLU, or of the minimum, lies between some
}

TEST_CASE("critics learn the soft target, and their copies follow by the share") {
  TwinCritic critic(small(), kShape, Rng(1));
  const Minibatch batch = drawn_batch();
  const std::vector<float> density(kLanes, -2.0f);
  const UpdateBatch update{batch, density, 0.5, Rng(0)};
  const auto next_first = values(critic, 0, batch.next_acted), next_second = values(critic, 1, batch.next_acted);
  double expected = 0.0;
  for (std::size_t which = 0; which < 2; ++which) {
    const auto now = values(critic, which, batch.taken);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double follows = std::min(next_first[lane], next_second[lane]) + 0.5 * 2.0;  // the copies start equal
      const double error = now[lane] - (batch.reward[lane] + 0.25 * batch.alive[lane] * follows);
      expected += error * error / kLanes;
    }
  }

  const double first_loss = critic.update(update);
  double last_loss = 0.0;
  for (int step = 0; step < 300; ++step) last_loss = critic.update(update);

  CHECK(first_loss == doctest::Approx(expected).epsilon(1e-5));
  CHECK(last_loss < 0.5 * first_loss);
}
