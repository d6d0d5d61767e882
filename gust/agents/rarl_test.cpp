#include "gust/agents/rarl.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "gust/core/hash.h"

using namespace gust;

namespace {

const Place kPlace{"test"};

Made<Plant> cartpole() { return plants().make({{{"kind", {std::string("cartpole"), kPlace}}}, kPlace}); }

Made<Agent> agent(const char* kind, std::vector<std::pair<std::string, Value>> options) {
  options.push_back({"kind", {std::string(kind), kPlace}});
  return agents().make({options, kPlace});
}

/// All that learning changes in one side.
std::string state_of(const PpoLearner& learner) {
  Saver saver;
  PpoLearner::archive(saver, learner);
  return hash_hex(saver.take());
}

/// A game of one step with a saddle: the actor moves u, the adversary pushes w. What counts is
///
///   r(u, w) = -(u - 1)^2 + 2 w^2 + u w = -(u - 1 - w / 2)^2 + 9/4 (w + 2/9)^2 - 1/9,
///
/// greatest over u and least over w at u = 8/9, w = -2/9, r = -1/9. The plant's reward is exp(r + 1/9), which has the
/// same saddle.
class SaddleGame final : public Plant {
 public:
  SaddleGame() {
    spec_.state = {{"a", "1"}, {"b", "1"}};
    spec_.action = {{"u", "1"}};
    spec_.force = {{"w", "1"}};
    spec_.control_rate = spec_.physics_rate = 1;
    spec_.steps = 1;
    spec_.action_scale = {1};
    spec_.action_offset = spec_.action_goal = {0};
    spec_.action_low = {-100};
    spec_.action_high = {100};
    spec_.start = {1, 1};
    spec_.start_offset = spec_.start_range = {0, 0};
    spec_.fail_low = {-1e9, -1e9};
    spec_.fail_high = {1e9, 1e9};
    spec_.wraps = {false, false};
    spec_.state_weights = {1, -2.25};
    spec_.error_weights = {1, 1};
  }

  const PlantSpec& spec() const override { return spec_; }
  void advance(const Motion& motion) const noexcept override {
    for (std::size_t lane = 0; lane < motion.state.lanes; ++lane) {
      const double u = motion.action.at(0, lane), w = motion.force.at(0, lane);
      motion.state.at(0, lane) = u - 1.0 - 0.5 * w;
      motion.state.at(1, lane) = w + 2.0 / 9.0;
    }
  }
  void reference(std::size_t, std::span<double> state) const noexcept override { std::ranges::fill(state, 0.0); }
  void begin(Rows<double>, std::size_t, bool) const noexcept override {}
  bool near_ground(std::span<const double>) const noexcept override { return false; }
  Linearisation linearise(std::span<const double>, std::span<const double>) const override {
    throw Bug("not linearised");
  }

 private:
  PlantSpec spec_;
};

}  // namespace

TEST_CASE("8.5.1 the adversary's rewards are the protagonist's, negated, to the bit") {
  const auto plant = cartpole();
  RarlTraining training({}, {plant.object.get(), {}, {}, 1});

  for (int i = 0; i < 6; ++i) {
    training.advance();
    const Rollout& ours = training.rollout();
    const Rollout& theirs = training.adversary_rollout();
    for (std::size_t s = 0; s < ours.samples(); ++s) REQUIRE(theirs.reward[s] == -ours.reward[s]);
    CHECK(std::ranges::equal(ours.observation, theirs.observation));
    CHECK(ours.done == theirs.done);
    CHECK(ours.truncated == theirs.truncated);
  }
}

TEST_CASE("8.5.2 without reach and without turns of the adversary RARL is PPO to the bit") {
  const auto plant = cartpole();
  RarlOptions options;
  options.steps = 20'000;
  options.scale = 0.0;  // neither is an option of a study: the first is PPO at twice the price, the second no game
  options.adversary_iterations = 0;
  for (const bool scaled : {false, true}) {
    options.normalise_observation = options.normalise_reward = scaled;
    const TrainingTask task{plant.object.get(), {}, {}, 3};
    RarlTraining rarl(options, task);
    const auto ppo = agent("ppo", {{"steps", {std::int64_t{20'000}, kPlace}},
                                   {"normalise_observation", {scaled, kPlace}},
                                   {"normalise_reward", {scaled, kPlace}}})
                         ->start(task);

    while (!rarl.done()) rarl.advance();
    while (!ppo->done()) ppo->advance();

    CHECK(std::ranges::equal(rarl.actor().mlp.parameters(), ppo->actor().mlp.parameters()));
    CHECK(rarl.curve().back().return_mean == ppo->curve().back().return_mean);
  }
}

TEST_CASE("8.5.3 a side keeps its parameters to the bit while the other one learns") {
  const auto plant = cartpole();
  for (const std::int64_t turns : {1, 3}) {
    RarlOptions options;
    options.agent_iterations = options.adversary_iterations = turns;
    RarlTraining training(options, {plant.object.get(), {}, {}, 1});
    for (std::int64_t rollout = 0; rollout < 4 * turns; ++rollout) {
      const std::string ours = state_of(training.protagonist()), theirs = state_of(training.adversary());
      training.advance();
      const bool our_turn = rollout / turns % 2 == 0;
      CHECK((state_of(training.protagonist()) == ours) == !our_turn);
      CHECK((state_of(training.adversary()) == theirs) == our_turn);
    }
  }
}

TEST_CASE("8.5.5 on a game of one step both sides find its saddle") {
  const SaddleGame game;
  for (const std::int64_t seed : {1, 2, 3}) {
    RarlOptions options;
    options.steps = 160'000;
    options.actor_rate = 1e-3;
    options.scale = 1.0;
    options.entropy = 0.0;
    options.discount = 0.0;  // the game ends with its step
    options.hidden = 16;
    options.log_std = -1.5;
    RarlTraining training(options, {&game, {.effort = "applied"}, {}, seed});

    while (!training.done()) training.advance();

    CAPTURE(seed);
    CHECK(training.failure().empty());
    const float u = training.rollout().mean.front(), w = training.adversary_rollout().mean.front();
    CHECK(std::abs(u - 8.0 / 9.0) < 0.05);
    CHECK(std::abs(w + 2.0 / 9.0) < 0.05);
  }
}

TEST_CASE("8.5.7 a round of RARL is 800 steps at one turn each and 8000 at ten") {
  const auto plant = cartpole();
  for (const std::int64_t turns : {1, 10}) {
    RarlOptions options;
    options.agent_iterations = options.adversary_iterations = turns;
    options.epochs = 1;
    options.steps = 1;  // rounded up to a round
    RarlTraining training(options, {plant.object.get(), {}, {}, 1});

    while (!training.done()) training.advance();

    CHECK(training.steps() == 800 * turns);
    CHECK(training.total_steps() == 800 * turns);
    CHECK(training.curve().back().steps == 800 * turns);
    CHECK(training.curve().back().protagonist_steps == 400 * turns);
    CHECK(training.protagonist().critic_steps() == 6 * turns);
    CHECK(training.adversary().critic_steps() == 6 * turns);
  }
}

TEST_CASE("RARL goes on from its bytes as if it had not stopped, adversary and all") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 7};
  for (const char* site : {"dynamics", "action", "observation"}) {
    RarlOptions options;
    options.site = site;
    options.steps = 20'000;
    options.epochs = 2;
    options.agent_iterations = 2;
    options.normalise_observation = true;
    for (const int rollouts : {1, 5, 14}) {
      RarlTraining whole(options, task), first(options, task), second(options, task);
      for (int i = 0; i < rollouts + 7; ++i) whole.advance();
      for (int i = 0; i < rollouts; ++i) first.advance();
      second.load(first.save());
      for (int i = 0; i < 7; ++i) second.advance();

      CHECK(second.save() == whole.save());
    }
  }
}

TEST_CASE("an adversary changes what is learned, at every site, and is handed out with its reach") {
  const auto plant = cartpole();
  std::vector<std::string> learned;
  for (const char* site : {"dynamics", "action", "observation"}) {
    RarlOptions options;
    options.site = site;
    options.scale = 0.5;
    RarlTraining training(options, {plant.object.get(), {}, {}, 1});
    for (int i = 0; i < 3; ++i) training.advance();
    learned.push_back(state_of(training.protagonist()));

    const std::vector<TrainedAdversary> adversaries = training.adversaries();
    REQUIRE(adversaries.size() == 1);
    CHECK(site_name(adversaries[0].against.site) == site);
    CHECK(adversaries[0].against.scale == 0.5);
    CHECK(adversaries[0].actor.observations() == 4);
    CHECK(adversaries[0].actor.actions() == channels_of(adversaries[0].against.site, plant->spec()).size());
  }
  CHECK(learned[0] != learned[1]);
  CHECK(learned[0] != learned[2]);
  CHECK(learned[1] != learned[2]);
}

TEST_CASE("a strong adversary learns to make the protagonist fail sooner") {
  const auto plant = cartpole();
  RarlOptions options;
  options.scale = 2.0;
  options.steps = 40'000;
  options.agent_iterations = 1;
  options.adversary_iterations = 49;
  RarlTraining training(options, {plant.object.get(), {}, {}, 1});
  const auto ends = [&] { return std::ranges::count(training.rollout().done, 1); };
  std::ptrdiff_t early = 0, late = 0;

  for (int i = 0; i < 10; ++i, early += ends()) training.advance();
  for (int i = 0; i < 80; ++i) training.advance();
  for (int i = 0; i < 10; ++i, late += ends()) training.advance();

  CHECK(late > early);
}

TEST_CASE("impossible options of RARL are errors that say what would be right") {
  const auto number = [](double value) { return Value{value, kPlace}; };
  CHECK_THROWS_WITH_AS(agent("rarl", {{"scale", number(0)}}), "test: 'scale' must be > 0, got 0", Error);
  CHECK_THROWS_WITH_AS(agent("rarl", {{"scale", number(-1)}}), "test: 'scale' must be > 0, got -1", Error);
  CHECK_THROWS_WITH_AS(agent("rarl", {{"site", {std::string("dynamic"), kPlace}}}),
                       "test: 'site' must be one of dynamics, action, observation, got 'dynamic'; did you mean "
                       "'dynamics'?",
                       Error);
  CHECK_THROWS_WITH_AS(agent("rarl", {{"adversary_iteration", {std::int64_t{1}, kPlace}}}),
                       "test: unknown key 'adversary_iteration' in rarl; did you mean 'adversary_iterations'?", Error);
  CHECK_THROWS_AS(agent("rarl", {{"agent_iterations", {std::int64_t{0}, kPlace}}}), Error);
  CHECK_THROWS_AS(agent("rarl", {{"minibatch", {std::int64_t{500}, kPlace}}}), Error);

  PlantSpec still = cartpole()->spec();
  still.force.clear();
  CHECK_THROWS_WITH_AS(agent("rarl", {})->check(still, kPlace),
                       "test: the plant has nothing at the site 'dynamics' that an adversary could act on", Error);
  CHECK_NOTHROW(agent("rarl", {{"site", {std::string("action"), kPlace}}})->check(still, kPlace));
}
