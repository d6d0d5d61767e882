#include "gust/agents/off_policy_learner.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/agents/twin_critic.h"

using namespace gust;

namespace {

constexpr TransitionShape kShape{.observations = 1, .actions = 1};

std::unique_ptr<Critic> twins(const OffPolicyOptions& options, const TransitionShape& shape, Rng rng) {
  return std::make_unique<TwinCritic>(options, shape, rng);
}

/// One state, episodes of one step, reward -(a - 0.3)^2 / 0.02: what is taught is this reward of the policy's own
/// actions, four a round, and an update for each.
struct Bandit {
  OffPolicyLearner learner;
  Replay replay{kShape, 100'000};
  std::uint64_t rounds = 0;

  explicit Bandit(const OffPolicyOptions& options, std::uint64_t seed = 1)
      : learner(options, kShape, {{0}, {1}}, twins, Rng(seed)) {}

  void train(int updates) {
    const std::vector<float> seen(4, 1.0f);
    std::vector<float> action(4);
    for (int done = 0; done < updates; done += 4) {
      rounds < 50 ? learner.actor().act_randomly(rounds, action) : learner.actor().act(seen, rounds, action);
      ++rounds;
      for (std::size_t lane = 0; lane < 4; ++lane) {
        const float off = action[lane] - 0.3f;
        replay.add({{&seen[lane], 1}, {&action[lane], 1}, {}, {&seen[lane], 1}, -off * off / 0.02f, true});
      }
      for (int i = 0; i < 4; ++i) learner.update(replay);
    }
  }

  double best_action() {
    ActorRunner runner(learner.actor().network(), 1);
    return runner.act(std::vector<float>{1.0f})[0];
  }

  /// Of the policy's actions.
  double entropy() {
    Tiles<float> seen(64, 1), judged(64, 2);
    std::ranges::fill(seen.tile(0), 1.0f);
    double sum = 0.0;
    for (int draw = 0; draw < 100; ++draw) {
      learner.actor().propose(seen, Rng(77).split(draw), 1, judged);
      for (std::size_t lane = 0; lane < 64; ++lane) sum -= learner.actor().log_density()[lane] / 6400.0;
    }
    return sum;
  }
};

OffPolicyOptions small() { return {.environments = 4, .hidden = 32, .batch = 64, .temperature = 0.01}; }

}  // namespace

TEST_CASE("8.4.6 the actor finds the best arm of a bandit") {
  for (const char* order : {"upstream", "original"}) {
    OffPolicyOptions options = small();
    options.sac_order = order;
    Bandit bandit(options);

    bandit.train(6'000);

    CHECK(std::abs(bandit.best_action() - 0.3) < 0.03);
  }
}

TEST_CASE("8.4.8 a fixed temperature is constant to the bit, an automatic one brings the entropy to its target") {
  Bandit fixed(small());
  const double before = fixed.learner.temperature().log_value();
  fixed.train(400);
  CHECK(fixed.learner.temperature().log_value() == before);

  OffPolicyOptions automatic = small();
  automatic.auto_temperature = true;
  automatic.temperature = 0.2;
  Bandit bandit(automatic);
  bandit.train(20'000);
  CHECK(std::abs(bandit.entropy() - -1.0) < 0.1);
}

TEST_CASE("a learner that is saved and loaded goes on to the same bits, in both orders") {
  for (const char* order : {"upstream", "original"}) {
    OffPolicyOptions options = small();
    options.sac_order = order;
    options.auto_temperature = true;
    Bandit whole(options);
    whole.train(400);
    Saver saver;
    whole.learner.save(saver);
    const std::string bytes = saver.take();
    Bandit resumed(options);
    Loader loader(bytes);
    resumed.learner.load(loader);
    resumed.replay = whole.replay;
    resumed.rounds = whole.rounds;

    whole.train(100);
    resumed.train(100);

    Saver first, second;
    whole.learner.save(first);
    resumed.learner.save(second);
    CHECK(first.take() == second.take());
    CHECK(whole.learner.updates() == 500);
  }
}

TEST_CASE("a minibatch may be prepared before it is learned from") {
  Bandit plain(small()), prepared(small());
  int calls = 0;
  prepared.learner.prepare([&](Minibatch& batch, Rng) {
    ++calls;
    std::ranges::fill(batch.reward, 0.0f);
  });

  plain.train(40);
  prepared.train(40);

  CHECK(calls == 40);
  CHECK_FALSE(plain.best_action() == prepared.best_action());
}
