#include "gust/agents/rap.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace gust;

namespace {

const Place kPlace{"test"};

Made<Plant> cartpole(std::int64_t steps = 250) {
  return plants().make({{{"kind", {std::string("cartpole"), kPlace}}, {"steps", {steps, kPlace}}}, kPlace});
}

Made<Agent> rap(std::vector<std::pair<std::string, Value>> options) {
  options.push_back({"kind", {std::string("rap"), kPlace}});
  return agents().make({options, kPlace});
}

}  // namespace

TEST_CASE("8.5.7 a round of RAP is 400 steps, of which both sides learn") {
  const auto plant = cartpole();
  RapOptions options;
  options.steps = 1;
  options.reset_each_rollout = true;  // one owner for the whole of it
  RapTraining training(options, {plant.object.get(), {}, {}, 1});

  while (!training.done()) training.advance();

  CHECK(training.steps() == 400);
  CHECK(training.curve().back().protagonist_steps == 400);
  CHECK(training.protagonist().critic_steps() == 60);
  std::int64_t steps = 0;
  for (const PpoLearner& adversary : training.population().learners()) steps += adversary.critic_steps();
  const auto of = [&](std::ptrdiff_t slots) { return 10 * (100 * slots / 64); };  // 1, 3, 4, 6 minibatches an epoch
  const std::ptrdiff_t first = std::ranges::count(training.population().owners(), 0u);
  CHECK(steps == of(first) + of(4 - first));
}

TEST_CASE("RAP goes on from its bytes as if it had not stopped, adversaries and all") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 7};
  for (const bool reset : {false, true}) {
    RapOptions options;
    options.steps = 20'000;
    options.epochs = 2;
    options.population = 3;
    options.reset_each_rollout = options.joint_advantages = reset;
    options.normalise_reward = reset;
    for (const int rollouts : {1, 5, 14}) {
      RapTraining whole(options, task), first(options, task), second(options, task);
      for (int i = 0; i < rollouts + 7; ++i) whole.advance();
      for (int i = 0; i < rollouts; ++i) first.advance();
      second.load(first.save());
      for (int i = 0; i < 7; ++i) second.advance();

      CHECK(second.save() == whole.save());
    }
  }
}

TEST_CASE("with a reset before each rollout no episode is older than a rollout") {
  const auto plant = cartpole(30);  // steps, which the pole stands by itself
  for (const bool reset : {false, true}) {
    RapOptions options;
    options.reset_each_rollout = reset;
    options.rollout = 20;
    options.epochs = 1;
    RapTraining training(options, {plant.object.get(), {}, {}, 1});
    bool truncated = false;

    for (int i = 0; i < 4; ++i) {
      training.advance();
      truncated = truncated || !training.rollout().truncated.empty();
    }

    CHECK(truncated == !reset);
  }
}

TEST_CASE("an environment keeps its adversary until its episode ends") {
  const auto plant = cartpole();
  RapOptions options;
  options.population = 8;
  options.environments = 16;
  options.rollout = 25;
  options.epochs = 1;
  RapTraining training(options, {plant.object.get(), {}, {}, 1});
  int kept = 0, drawn = 0;

  for (int i = 0; i < 40; ++i) {
    const std::vector<std::size_t> before(training.population().owners().begin(), training.population().owners().end());
    training.advance();
    for (std::size_t e = 0; e < 16; ++e) {
      bool ended = false;
      for (std::size_t step = 0; step < 25; ++step) ended = ended || training.rollout().done[16 * step + e];
      const bool same = training.population().owners()[e] == before[e];
      CHECK((ended || same));
      (ended ? drawn : kept) += same ? 0 : 1;
    }
  }

  CHECK(kept == 0);
  CHECK(drawn > 0);
}

TEST_CASE("a population is handed out with the reach of each") {
  const auto plant = cartpole();
  RapOptions options;
  options.population = 4;
  options.strength_bins = 2;
  const RapTraining training(options, {plant.object.get(), {}, {}, 1});

  const std::vector<TrainedAdversary> adversaries = training.adversaries();

  REQUIRE(adversaries.size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(adversaries[k].against.site == Site::kAction);
    CHECK(adversaries[k].against.scale == (k % 2 == 0 ? 0.05 : 0.1));
    CHECK(adversaries[k].actor.actions() == 1);
  }
}

TEST_CASE("impossible options of RAP are errors that say what would be right") {
  const auto integer = [](std::int64_t value) { return Value{value, kPlace}; };
  CHECK_THROWS_WITH_AS(rap({{"population", integer(0)}}), "test: 'population' must be 1 to 8, got 0", Error);
  CHECK_THROWS_AS(rap({{"population", integer(9)}}), Error);
  CHECK_THROWS_AS(rap({{"scale", {-0.1, kPlace}}}), Error);
  CHECK_THROWS_WITH_AS(rap({{"reset_each_rolout", {true, kPlace}}}),
                       "test: unknown key 'reset_each_rolout' in rap; did you mean 'reset_each_rollout'?", Error);
}
