#include <doctest/doctest.h>

#include <algorithm>

#include "gust/agents/agent.h"

using namespace gust;

namespace {

using Options = std::vector<std::pair<std::string, Value>>;

Value number(double value) { return {value, {"test"}}; }
Value integer(std::int64_t value) { return {value, {"test"}}; }

Made<Plant> cartpole(bool normalised) {
  return plants().make({{{"kind", {std::string("cartpole"), {}}}, {"normalized_action", {normalised, {}}}}, {"test"}});
}

Made<Agent> sac(Options options, std::int64_t hidden = 32) {
  options.push_back({"kind", {std::string("sac"), {"test"}}});
  options.push_back({"hidden", integer(hidden)});
  return agents().make({options, {"test"}});
}

}  // namespace

TEST_CASE("soft actor-critic learns to keep the pole upright, in newtons and in normalised actions") {
  for (const bool normalised : {false, true}) {
    const auto plant = cartpole(normalised);
    const auto training = sac({{"steps", integer(12'000)}}, 64)->start({plant.object.get(), {}, {}, 1});

    while (!training->done()) training->advance();

    CHECK(training->failure().empty());
    CHECK(training->curve().front().anr_h < 0.3);
    CHECK(training->curve().back().anr_h > (normalised ? 0.9 : 0.4));  // two of three seeds reach 0.93 in newtons
    CHECK(training->actor().box == ActionBox{{0}, {normalised ? 1.0f : 10.0f}});
  }
}

TEST_CASE("equal seeds train equal actors, other seeds and the other order others") {
  const auto plant = cartpole(true);
  std::vector<std::vector<float>> actors;
  for (const auto& [seed, order] :
       std::vector<std::pair<int, const char*>>{{1, "upstream"}, {1, "upstream"}, {2, "upstream"}, {1, "original"}}) {
    const auto agent = sac({{"steps", integer(1'500)}, {"sac_order", {std::string(order), {}}}});
    const auto training = agent->start({plant.object.get(), {}, {}, seed});
    while (!training->done()) training->advance();
    const ActorNetwork actor = training->actor();
    actors.emplace_back(actor.mlp.parameters().begin(), actor.mlp.parameters().end());
  }

  CHECK(actors[0] == actors[1]);
  CHECK(actors[0] != actors[2]);
  CHECK(actors[0] != actors[3]);
}

TEST_CASE("a soft actor-critic whose numbers are not finite ends with a reason") {
  const auto plant = cartpole(true);
  const auto training =
      sac({{"steps", integer(40'000)}, {"critic_rate", number(1e30)}})->start({plant.object.get(), {}, {}, 1});

  while (!training->done()) training->advance();

  CHECK(training->steps() < 40'000);
  CHECK(training->failure().find("finite") != std::string::npos);
}

TEST_CASE("impossible options of soft actor-critic are errors that say what would be right") {
  CHECK_THROWS_WITH_AS(sac({{"batch", integer(500)}, {"buffer", integer(400)}, {"burst", integer(1)}}),
                       "test: 'batch' must be at most 'buffer' = 400, got 500", Error);
  CHECK_THROWS_AS(sac({{"temperature", number(0)}}), Error);
  CHECK_THROWS_AS(sac({{"polyak", number(0)}}), Error);
  CHECK_THROWS_AS(sac({{"discount", number(1.5)}}), Error);
  CHECK_THROWS_WITH_AS(sac({{"bufer", integer(5)}}), doctest::Contains("did you mean 'buffer'"), Error);
}
