#include "gust/agents/agent_fixture_test.h"

using namespace gust;

namespace {

Made<Agent> raac(Options options) {
  options.push_back({"kind", text("raac")});
  options.push_back({"hidden", integer(32)});
  options.push_back({"fractions", integer(8)});
  options.push_back({"target_fractions", integer(8)});
  return agents().make({options, {"test"}});
}

}  // namespace

TEST_CASE("RAAC learns to hold the pole up") {
  const auto plant = cartpole();
  const auto training =
      raac({{"steps", integer(20'000)}, {"kappa", number(0.05)}})->start({plant.object.get(), {}, {}, 1});

  while (!training->done()) training->advance();

  CHECK(training->failure().empty());
  CHECK(training->curve().back().anr_h > 0.5);
}

TEST_CASE("RAAC that is saved and loaded goes on to the same bits, in all its forms") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 7};
  for (const Options& options :
       {Options{}, Options{{"fraction_sets", text("own")}, {"batch", integer(70)}}, Options{{"critics", integer(1)}}}) {
    Options all = options;
    all.push_back({"steps", integer(3'000)});
    const auto agent = raac(all);
    const auto whole = agent->start(task);
    const auto first = agent->start(task);
    for (int i = 0; i < 6; ++i) whole->advance();
    for (int i = 0; i < 3; ++i) first->advance();

    const auto second = agent->start(task);
    second->load(first->save());
    for (int i = 0; i < 3; ++i) second->advance();

    CHECK(second->save() == whole->save());
  }
}

TEST_CASE("RAAC whose numbers are none ends with a reason") {
  const auto plant = cartpole();
  const auto training =
      raac({{"steps", integer(40'000)}, {"critic_rate", number(1e30)}})->start({plant.object.get(), {}, {}, 1});

  while (!training->done()) training->advance();

  CHECK(training->steps() < 40'000);
  CHECK(training->failure().find("finite") != std::string::npos);
}

TEST_CASE("impossible options of RAAC are errors that say what would be right") {
  CHECK_THROWS_AS(raac({{"alpha", number(0)}}), Error);
  CHECK_THROWS_AS(raac({{"alpha", number(1.01)}}), Error);
  CHECK_THROWS_AS(raac({{"kappa", number(0)}}), Error);
  CHECK_THROWS_AS(raac({{"critics", integer(3)}}), Error);
  CHECK_THROWS_AS(raac({{"actor_fractions", integer(0)}}), Error);
  CHECK_THROWS_WITH_AS(raac({{"kapa", number(1)}}), doctest::Contains("did you mean 'kappa'"), Error);
}
