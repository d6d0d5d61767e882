#include "gust/eval/evaluate.h"

#include <doctest/doctest.h>

#include <vector>

#include "gust/control/plant_loops.h"

namespace gust {
namespace {

Made<Plant> cartpole() {
  return plants().make({{{"kind", Value{std::string("cartpole"), {}}}, {"steps", Value{std::int64_t{40}, {}}}}, {}});
}

Table noise() {
  Table table;
  table.set("site", Value{std::string("dynamics"), {}});
  table.set("waveform", Value{std::string("white"), {}});
  return table;
}

/// Two levels of noise, from rest and from five random starts, on the bare plant.
struct Scene {
  Made<Plant> plant = cartpole();
  std::vector<Injection> injections = {read_injection(noise(), plant->spec())};
  PlantLoops loops{plant.object, {}};
  Evaluation evaluation;

  Scene() {
    evaluation.source = &loops;
    evaluation.injections = injections;
    const std::vector<double> parameters = nominal_parameters(plant->spec());
    evaluation.cells = {{{0.5}, parameters}, {{2.0}, parameters}};
    evaluation.starts = loops.starts();
    evaluation.episodes = 5;
    evaluation.root = Rng(11);
  }

  struct Taken {
    EpisodeIndex index;
    Episode episode;
  };

  std::vector<Taken> taken(std::size_t lanes = 256) const {
    const auto policy = zero_policy(plant->spec().observations(), plant->spec().action.size());
    std::vector<Taken> all;
    evaluate(
        evaluation, *policy,
        [&](const EpisodeIndex& index, const Episode& episode) {
          all.push_back({index, episode});
        },
        lanes);
    return all;
  }
};

TEST_CASE("episodes come in the order cell, start, episode, and none is left out") {
  const auto taken = Scene().taken(/*lanes=*/3);

  REQUIRE(taken.size() == 2 * 2 * 5);
  for (std::size_t i = 0; i < taken.size(); ++i) {
    CHECK(taken[i].index.cell == i / 10);
    CHECK(taken[i].index.start == i / 5 % 2);
    CHECK(taken[i].index.episode == static_cast<std::int64_t>(i % 5));
  }
}

TEST_CASE("the bits of an episode do not depend on how many run side by side") {
  const Scene scene;
  const auto together = scene.taken();

  for (const std::size_t lanes : {1, 7}) {
    const auto apart = scene.taken(lanes);
    REQUIRE(apart.size() == together.size());
    for (std::size_t i = 0; i < apart.size(); ++i) {
      CHECK(apart[i].episode.whole.return_sum == together[i].episode.whole.return_sum);
      CHECK(apart[i].episode.whole.final_state == together[i].episode.whole.final_state);
    }
  }
}

TEST_CASE("every level meets the same starts and the same noise") {
  Scene scene;
  scene.evaluation.cells[0].levels = {0.0};
  scene.evaluation.cells[1].levels = {0.0};

  const auto taken = scene.taken();

  for (std::size_t i = 0; i < 10; ++i)
    CHECK(taken[i].episode.whole.final_state == taken[i + 10].episode.whole.final_state);
  CHECK(taken[5].episode.whole.final_state != taken[6].episode.whole.final_state);
  const EpisodeIndex low{0, 1, 3};
  const EpisodeIndex high{1, 1, 3};
  CHECK(start_state(scene.evaluation, low) == start_state(scene.evaluation, high));
}

TEST_CASE("an episode without anything drawn is run once and counted as often as it was asked for") {
  Scene scene;
  scene.injections.clear();
  scene.evaluation.injections = {};
  for (SweepCell& cell : scene.evaluation.cells) cell.levels.clear();

  const auto taken = scene.taken();

  REQUIRE(taken.size() == 20);
  for (std::size_t i = 1; i < 5; ++i) {
    CHECK(taken[i].index.episode == static_cast<std::int64_t>(i));
    CHECK(taken[i].episode.whole.final_state == taken[0].episode.whole.final_state);
  }
  CHECK(taken[0].episode.whole.return_sum == 40.0);  // at the goal from the start, a reward of 1 a step
}

TEST_CASE("a trace is the episode that was measured, step by step") {
  const Scene scene;
  const auto policy = zero_policy(4, 1);
  const auto taken = scene.taken();

  const Trace trace = trace_episode(scene.evaluation, *policy, {1, 1, 2});

  const Episode& measured = taken[10 + 5 + 2].episode;
  double sum = 0;
  for (const double reward : trace.reward) sum += reward;
  CHECK(sum == measured.whole.return_sum);
  CHECK(trace.failed_at == (measured.failed ? measured.safe_steps : -1));
  for (std::size_t i = 0; i < 4; ++i) CHECK(trace.state.at(i, 40) == measured.whole.final_state[i]);
  CHECK(trace.force.at(0, 7) == 2.0 * episode_signals(scene.evaluation, trace.index)->channel(0, 0)[7]);
}

}  // namespace
}  // namespace gust
