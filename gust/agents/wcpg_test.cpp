#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "gust/agents/agent_fixture_test.h"
#include "gust/agents/off_policy_training.h"

using namespace gust;

namespace {

Made<Agent> wcpg(Options options) {
  options.push_back({"kind", text("wcpg")});
  options.push_back({"hidden", integer(32)});
  return agents().make({options, {"test"}});
}

/// The profile wcpg-fixed, in short.
const Options kFixed = {{"variance_target", text("squared_td")}, {"variance_loss", text("divergence")}};

}  // namespace

TEST_CASE("8.6.7 a risk level holds for an episode, is uniform over episodes, and is one number of a transition") {
  const auto plant = cartpole();
  const auto agent = wcpg({{"steps", integer(60'000)}, {"warm_up", integer(60'000)}, {"environments", integer(1)}});
  const auto training = agent->start({plant.object.get(), {}, {}, 1});
  while (!training->done()) training->advance();

  const Replay& replay = dynamic_cast<OffPolicyTraining&>(*training).replay();
  const TransitionShape& shape = replay.shape();
  REQUIRE(shape.extras == 1);
  std::vector<double> levels;
  bool held = true;
  bool begins = true;
  for (std::int64_t i = 0; i < replay.size(); ++i) {  // one environment: in the order of its steps
    const std::span<const float> row = replay.row(i);
    const double level = row[shape.extra_at()];
    if (begins) {
      levels.push_back(level);
    } else {
      held = held && level == levels.back();
    }
    const bool follows = i + 1 < replay.size() && std::ranges::equal(row.subspan(shape.next_at(), shape.observations),
                                                                     replay.row(i + 1).first(shape.observations));
    begins = !follows;
  }
  CHECK(held);
  std::ranges::sort(levels);
  REQUIRE(levels.size() > 500);
  double distance = 0.0;  // Kolmogorov and Smirnov's
  const auto count = static_cast<double>(levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double share = (levels[i] - 0.01) / 0.99;
    distance = std::max({distance, std::abs(share - static_cast<double>(i) / count),
                         std::abs(share - static_cast<double>(i + 1) / count)});
  }
  CHECK(distance * std::sqrt(count) < 1.95);  // p > 1e-3
}

TEST_CASE("WCPG learns to keep the pole upright at every risk level") {
  const auto plant = cartpole();
  Options options = kFixed;
  options.push_back({"steps", integer(20'000)});
  const auto agent = wcpg(options);
  const TrainingTask task{plant.object.get(), {}, {}, 1};
  const auto training = agent->start(task);

  while (!training->done()) training->advance();

  CHECK(training->failure().empty());
  CHECK(training->curve().back().anr_h > 0.5);
  ActorNetwork actor = training->actor();
  CHECK(actor.alpha == 0.3f);
  CHECK(actor.observations() == 4);
}

TEST_CASE("WCPG that is saved and loaded goes on to the same bits, relabelled or not") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 7};
  for (const bool relabel : {false, true}) {
    const auto agent = wcpg({{"steps", integer(3'000)}, {"alpha_relabel", {relabel, {}}}});
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

TEST_CASE("a relabelled training learns at other levels than those it acted at") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 7};
  std::set<std::vector<float>> actors;
  for (const bool relabel : {false, true}) {
    const auto training = wcpg({{"steps", integer(1'200)}, {"alpha_relabel", {relabel, {}}}})->start(task);
    while (!training->done()) training->advance();
    const ActorNetwork actor = training->actor();
    actors.emplace(actor.mlp.parameters().begin(), actor.mlp.parameters().end());
  }
  CHECK(actors.size() == 2);
}

TEST_CASE("WCPG whose numbers are not finite ends with a reason") {
  const auto plant = cartpole();
  const auto training =
      wcpg({{"steps", integer(40'000)}, {"critic_rate", number(1e30)}})->start({plant.object.get(), {}, {}, 1});

  while (!training->done()) training->advance();

  CHECK(training->steps() < 40'000);
  CHECK(training->failure().find("finite") != std::string::npos);
}

TEST_CASE("impossible risk levels of WCPG are errors that say what would be right") {
  CHECK_THROWS_AS(wcpg({{"alpha_min", number(0)}}), Error);
  CHECK_THROWS_AS(wcpg({{"alpha_max", number(1.5)}}), Error);
  CHECK_THROWS_WITH_AS(wcpg({{"alpha_min", number(0.5)}, {"alpha_max", number(0.25)}}),
                       "test: 'alpha_min' must be at most 'alpha_max' = 0.25, got 0.5", Error);
  CHECK_THROWS_WITH_AS(wcpg({{"alpha_min", number(0.5)}}),
                       "test: 'alpha' must be from 'alpha_min' to 'alpha_max', 0.5 to 1, got 0.3", Error);
  CHECK_THROWS_AS(wcpg({{"cvar_coef", text("printed")}}), Error);
  CHECK_THROWS_WITH_AS(wcpg({{"variance_loss", text("divergence")}}),
                       "test: 'variance_loss' divergence needs 'variance_target' squared_td: the other may be negative",
                       Error);
  CHECK_NOTHROW(wcpg({{"alpha_min", number(0.1)}, {"alpha_max", number(0.1)}}));  // a fixed level needs no other
}
