#include <cmath>

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

/// A mean over seeds, and how far its 95 % interval (Student, nine degrees of freedom) reaches to either side.
struct MeanScore {
  double mean = 0;
  double reach = 0;
};

/// Of ten seeds, at the end of the training.
MeanScore final_score(const Agent& agent) {
  constexpr int kSeeds = 10;
  const auto plant = plants().make({{{"kind", text("cartpole")}, {"normalized_action", {true, {"test"}}}}, {"test"}});
  double sum = 0.0, squares = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const auto training = agent.start({plant.object.get(), {}, {}, seed});
    while (!training->done()) training->advance();
    const double score = training->curve().back().anr_h;
    sum += score;
    squares += score * score;
  }
  const double mean = sum / kSeeds;
  return {mean, 2.262 * std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1))};
}

}  // namespace

TEST_CASE("8.7.6 at level 1 the score on the cart-pole is soft actor-critic's") {
  const Options common = {{"hidden", integer(64)}, {"steps", integer(15'000)}};
  Options plain = common, quantiles = common;
  plain.push_back({"kind", text("sac")});
  quantiles.insert(quantiles.end(), {{"kind", text("raac")}, {"alpha", number(1)}, {"kappa", number(0.05)}});

  const MeanScore sac = final_score(*agents().make({plain, {"test"}}));
  const MeanScore raac = final_score(*agents().make({quantiles, {"test"}}));

  CAPTURE(sac.mean);
  CAPTURE(sac.reach);
  CAPTURE(raac.mean);
  CAPTURE(raac.reach);
  CHECK(sac.mean > 0.9);
  CHECK(raac.mean > 0.9);
  CHECK(std::abs(sac.mean - raac.mean) <= sac.reach + raac.reach);
}

TEST_CASE("RAAC learns to keep the pole upright") {
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

TEST_CASE("RAAC whose numbers are not finite ends with a reason") {
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
