#include "gust/nn/actor_network.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/nn/initialise.h"

using namespace gust;

namespace {

Mlp<float> network(std::vector<std::size_t> sizes) {
  Mlp<float> mlp({.sizes = std::move(sizes), .activation = Activation::kRelu});
  initialise_uniform(mlp, Rng(3));
  return mlp;
}

}  // namespace

TEST_CASE("an actor with a box acts within it, by the tanh of its outputs") {
  const ActorNetwork actor{network({3, 32, 2}), ActionBox{{1.0f, 0.0f}, {0.5f, 10.0f}}};
  MlpWorkspace<float> workspace(actor.mlp.shape(), 2);
  const std::vector<float> observation = {0.1f, -2.0f, 0.7f, 90.0f, 0.0f, -50.0f};
  ActorRunner runner(actor, 2);

  const auto sums = workspace.forward(actor.mlp, observation);
  const auto actions = runner.act(observation);

  for (std::size_t i = 0; i < 4; ++i) {
    const double expected = actor.box->centre[i % 2] + actor.box->half_width[i % 2] * std::tanh(double{sums[i]});
    CHECK(std::abs(actions[i] - expected) < 1e-5);
  }
}

TEST_CASE("an actor without a box gives the outputs of its network") {
  const ActorNetwork actor{network({3, 32, 2})};
  MlpWorkspace<float> workspace(actor.mlp.shape(), 1);
  const std::vector<float> observation = {0.1f, -2.0f, 0.7f};
  ActorRunner runner(actor, 1);

  CHECK(std::ranges::equal(runner.act(observation), workspace.forward(actor.mlp, observation)));
}

TEST_CASE("the level of a conditional actor is its last input, and may be made part of its biases") {
  for (const auto& sizes : {std::vector<std::size_t>{4, 32, 2}, std::vector<std::size_t>{4, 2}}) {
    const ActorNetwork actor{network(sizes), {}, 0.3f};
    MlpWorkspace<float> workspace(actor.mlp.shape(), 1);
    const std::vector<float> standard = {0.1f, -2.0f, 0.7f, 0.3f}, other = {0.1f, -2.0f, 0.7f, 0.9f};

    ActorRunner at_standard(actor, 1), at_other(at_level(actor, 0.9f), 1);

    CHECK(actor.observations() == 3);
    const auto expected = workspace.forward(actor.mlp, standard);
    const auto got = at_standard.act(std::span(standard).first(3));
    for (std::size_t i = 0; i < 2; ++i) CHECK(std::abs(got[i] - expected[i]) < 1e-6);
    const auto expected_other = workspace.forward(actor.mlp, other);
    const auto got_other = at_other.act(std::span(other).first(3));
    for (std::size_t i = 0; i < 2; ++i) CHECK(std::abs(got_other[i] - expected_other[i]) < 1e-6);
  }
}
