#include "gust/agents/squashed_actor.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/core/error.h"

using namespace gust;

namespace {

constexpr std::size_t kLanes = 100;

OffPolicyOptions small(std::int64_t environments = 4) {
  return {.environments = environments, .hidden = 32, .batch = kLanes, .actor_rate = 1e-2};
}

const ActionBox kBox{{1.0f, 0.0f}, {2.0f, 0.5f}};

Tiles<float> observations(std::size_t features) {
  Tiles<float> tiles(kLanes, features);
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    for (std::size_t i = 0; i < features; ++i) tiles.at(lane, i) = static_cast<float>(Rng(8).normal(lane * 10 + i));
  return tiles;
}

}  // namespace

TEST_CASE("the box of a plant is -1 to 1 for normalised actions, else the actuator's bounds") {
  PlantSpec spec;
  spec.action = {{"u", "N"}};
  spec.action_low = {-2};
  spec.action_high = {10};

  CHECK(action_box(spec) == ActionBox{{4}, {6}});
  spec.normalized_action = true;
  CHECK(action_box(spec) == ActionBox{{0}, {1}});
  spec.normalized_action = false;
  spec.action_high = {INFINITY};
  CHECK_THROWS_WITH_AS(action_box(spec), "a squashed policy needs bounds of 'u', got -2 to inf", Error);
}

TEST_CASE("actions are drawn within the box, from streams of their own for every environment and step") {
  SquashedActor four(small(4), 3, kBox, Rng(1)), two(small(2), 3, kBox, Rng(1));
  const std::vector<float> seen(4 * 3, 0.3f);
  std::vector<float> first(8), again(8), fewer(4), later(8), random(8);

  four.act(seen, 5, first);
  four.act(seen, 6, later);
  four.act(seen, 5, again);
  two.act(std::span(seen).first(6), 5, fewer);
  four.act_randomly(5, random);

  CHECK(first == again);
  CHECK(first != later);
  CHECK(std::equal(fewer.begin(), fewer.end(), first.begin()));
  for (const auto& actions : {first, later, random}) {
    for (std::size_t i = 0; i < actions.size(); ++i)
      CHECK(std::abs(actions[i] - kBox.centre[i % 2]) <= kBox.half_width[i % 2]);
  }
}

TEST_CASE("the deterministic actor is the middle of what is drawn, before it is squashed") {
  OffPolicyOptions options = small();
  SUBCASE("every hidden layer activated") {}
  SUBCASE("the last one linear") { options.actor_trunk = "scg"; }
  SquashedActor actor(options, 3, kBox, Rng(2));
  const std::vector<float> seen = {0.5f, -1.0f, 0.1f};
  std::vector<float> action(2);
  double mean[2] = {};
  for (std::uint64_t step = 0; step < 40'000; ++step) {
    actor.act(seen, step, action);
    for (int d = 0; d < 2; ++d) mean[d] += std::atanh((action[d] - kBox.centre[d]) / kBox.half_width[d]) / 40'000;
  }
  ActorRunner runner(actor.network(), 1);
  CHECK(actor.network().mlp.shape().layers() == (options.actor_trunk == "scg" ? 2 : 3));

  const auto middle = runner.act(seen);

  for (int d = 0; d < 2; ++d)
    CHECK(std::abs(kBox.centre[d] + kBox.half_width[d] * std::tanh(mean[d]) - middle[d]) < 0.03);
}

TEST_CASE("steps along a value's gradient raise the value, and a temperature keeps the density low") {
  for (const double temperature : {1e-3, 1.0}) {
    SquashedActor actor(small(), 3, kBox, Rng(3));
    const Tiles<float> input = observations(3);
    Tiles<float> judged(kLanes, 5), slope(kLanes, 2);
    for (int step = 0; step < 600; ++step) {
      actor.propose(input, Rng(9).split(step), 3, judged);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {  // value -(a - (2, 0.25))^2
        slope.at(lane, 0) = -2.0f * (judged.at(lane, 3) - 2.0f);
        slope.at(lane, 1) = -2.0f * (judged.at(lane, 4) - 0.25f);
      }
      actor.improve(slope, temperature);
    }

    double density = 0.0, distance = 0.0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      density += actor.log_density()[lane] / kLanes;
      distance += std::abs(judged.at(lane, 3) - 2.0f) / kLanes;
    }
    if (temperature < 0.1) {
      CHECK(distance < 0.1);
      CHECK(density > 2.0);
    } else {
      CHECK(distance > 0.3);
      CHECK(density < 0.5);
    }
  }
}
