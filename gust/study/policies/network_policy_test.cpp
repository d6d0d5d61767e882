#include "gust/study/policies/network_policy.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "gust/core/rng.h"

using namespace gust;

namespace {

constexpr std::size_t kObservations = 3, kHidden = 5, kActions = 2;

/// Weights large enough that the tanhs bend, and a box if there is one.
ActorNetwork actor(bool boxed) {
  ActorNetwork actor{Mlp<float>({.sizes = {kObservations, kHidden, kActions}, .activation = Activation::kTanh})};
  const Rng rng(7);
  std::uint64_t draw = 0;
  for (std::size_t layer = 0; layer < 2; ++layer) {
    for (std::size_t o = 0; o < (layer == 0 ? kHidden : kActions); ++o) {
      actor.mlp.bias(layer, o) = static_cast<float>(rng.normal(draw++));
      for (std::size_t i = 0; i < (layer == 0 ? kObservations : kHidden); ++i)
        actor.mlp.weight(layer, o, i) = static_cast<float>(rng.normal(draw++));
    }
  }
  if (boxed) actor.box = ActionBox{{1, -2}, {3, 0.5}};
  return actor;
}

Matrix<double> observations(std::size_t lanes) {
  Matrix<double> result(kObservations, lanes);
  for (std::size_t i = 0; i < kObservations; ++i) {
    for (std::size_t lane = 0; lane < lanes; ++lane) result.at(i, lane) = Rng(9).normal(i * lanes + lane);
  }
  return result;
}

Matrix<double> act(Policy& policy, const Matrix<double>& observation) {
  Matrix<double> action(kActions, observation.lanes());
  policy.act(observation.view(), std::vector<std::int64_t>(observation.lanes()), action.view());
  return action;
}

std::unique_ptr<Policy> policy(const ActorNetwork& actor, Arithmetic arithmetic) {
  return network_policy(read_onnx(write_onnx(actor, {}), "x.onnx"), arithmetic);
}

/// The action by its formula, in double, from the rounded observation of one lane.
double expected(const ActorNetwork& actor, const Matrix<double>& observation, std::size_t lane, std::size_t action) {
  double output = actor.mlp.bias(1, action);
  for (std::size_t h = 0; h < kHidden; ++h) {
    double sum = actor.mlp.bias(0, h);
    for (std::size_t i = 0; i < kObservations; ++i)
      sum += static_cast<double>(actor.mlp.weight(0, h, i)) * static_cast<float>(observation.at(i, lane));
    output += actor.mlp.weight(1, action, h) * std::tanh(sum);
  }
  return actor.box ? actor.box->centre[action] + actor.box->half_width[action] * std::tanh(output) : output;
}

}  // namespace

TEST_CASE("a network's action is its formula's, in double nearly exactly, in float32 to float32's rounding") {
  const Matrix<double> observation = observations(150);
  for (const bool boxed : {false, true}) {
    const ActorNetwork network = actor(boxed);
    const Matrix<double> wide = act(*policy(network, Arithmetic::kDouble), observation);
    const Matrix<double> narrow = act(*policy(network, Arithmetic::kFloat), observation);
    for (std::size_t lane = 0; lane < observation.lanes(); ++lane) {
      for (std::size_t i = 0; i < kActions; ++i) {
        CHECK(std::abs(wide.at(i, lane) - expected(network, observation, lane, i)) < 1e-8);
        CHECK(std::abs(narrow.at(i, lane) - wide.at(i, lane)) < 1e-5);
      }
    }
  }
}

TEST_CASE("the bits of an action depend neither on the other lanes nor on their number; a NaN stays in its lane") {
  Matrix<double> observation = observations(150);  // more than two groups of lanes
  observation.at(1, 70) = std::numeric_limits<double>::quiet_NaN();
  for (const Arithmetic arithmetic : {Arithmetic::kDouble, Arithmetic::kFloat}) {
    const auto network = policy(actor(true), arithmetic);
    const Matrix<double> together = act(*network, observation);
    for (std::size_t lane = 0; lane < observation.lanes(); ++lane) {
      Matrix<double> one(kObservations, 1);
      for (std::size_t i = 0; i < kObservations; ++i) one.at(i, 0) = observation.at(i, lane);
      const Matrix<double> alone = act(*network, one);
      for (std::size_t i = 0; i < kActions; ++i) {
        CHECK(std::isnan(together.at(i, lane)) == (lane == 70));
        if (lane != 70) CHECK(alone.at(i, 0) == together.at(i, lane));
      }
    }
  }
}

TEST_CASE("an action is not clipped") {
  ActorNetwork network = actor(false);
  network.mlp.bias(1, 0) = 1000;
  for (const Arithmetic arithmetic : {Arithmetic::kDouble, Arithmetic::kFloat})
    CHECK(act(*policy(network, arithmetic), observations(1)).at(0, 0) > 900);
}
