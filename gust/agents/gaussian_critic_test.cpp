#include "gust/agents/gaussian_critic.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/agents/off_policy_learner.h"

using namespace gust;

namespace {

constexpr std::size_t kLanes = 128;
constexpr TransitionShape kShape{.observations = 1, .actions = 1, .extras = 1};

WcpgOptions small() {
  WcpgOptions options;
  options.hidden = 24;
  options.batch = kLanes;
  options.discount = 0.9;
  options.polyak = 0.02;
  options.temperature = 1e-3;
  return options;
}
WcpgOptions fixed_profile() {
  WcpgOptions options = small();
  options.variance_target = "squared_td";
  options.variance_loss = "unbiased";
  return options;
}
WcpgOptions squared_wasserstein() {
  WcpgOptions options = small();
  options.variance_target = "squared_td";
  return options;
}

/// Critics that learn a chain of states, or one state for ever, with rewards of a mean and deviation of one (or none),
/// at the level where the risk is the mean, without entropy.
struct Chain {
  GaussianCritic critic;
  std::size_t length;  // 0: one state for ever
  double spread;
  Minibatch batch{kShape, kLanes};
  std::uint64_t updates = 0;

  Chain(const WcpgOptions& options, std::size_t states, double deviation = 1.0)
      : critic(options, kShape, Rng(4)), length(states), spread(deviation) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) batch.set_extra(lane, 0, 1.0f);
  }
  void train(int count) {
    const std::vector<float> density(kLanes, 0.0f);
    for (int i = 0; i < count; ++i, ++updates) {
      const Rng rng = Rng(9).split(updates);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::size_t state = length == 0 ? 0 : rng.split("state").below(length, lane);
        batch.taken.at(lane, 0) = at(state);
        batch.next_acted.at(lane, 0) = at(length == 0 ? 0 : state + 1);
        batch.alive[lane] = length == 0 || state + 1 < length ? 1.0f : 0.0f;
        batch.reward[lane] = static_cast<float>(1.0 + spread * rng.normal(lane));
      }
      critic.learn({batch, density, 0.0, rng});
    }
  }
  float at(std::size_t state) const { return length == 0 ? 1.0f : static_cast<float>(state) / 5.0f - 1.0f; }

  /// The mean of both critics' laws of a state, over some more updates: what is left is no noise of the last minibatch.
  ReturnLaw law(std::size_t state, int rounds = 100) {
    Tiles<float> input(1, 3);
    input.at(0, 0) = at(state);
    input.at(0, 2) = 1.0f;
    double mean = 0.0, variance = 0.0;
    for (int round = 0; round < rounds; ++round) {
      train(10);
      for (const std::size_t which : {0u, 1u}) {
        const ReturnLaw one = critic.laws(which, input)[0];
        mean += one.mean / (2.0 * rounds);
        variance += one.variance() / (2.0 * rounds);
      }
    }
    return {mean, std::sqrt(variance)};
  }
};

/// One step, an action a in 0 … 1, reward N(a, a^4): the best action at a level is 1 / (2 c), or 1 (algorithms 8.6.6).
/// Actions and levels of the memory are uniform.
struct RiskBandit {
  OffPolicyLearner learner;
  // So many that the fit of a variance by single squares, whose noise is that of the largest actions, is no matter.
  static constexpr std::uint64_t kMemory = 1'000'000;
  Replay replay{kShape, kMemory};

  explicit RiskBandit(const WcpgOptions& options)
      : learner(
            options, kShape, {{0.5f}, {0.5f}},
            [options](const OffPolicyOptions&, const TransitionShape& shape, Rng rng) {
              return std::make_unique<GaussianCritic>(options, shape, rng);
            },
            Rng(1)) {
    const float seen = 1.0f;
    for (std::uint64_t i = 0; i < kMemory; ++i) {
      const auto action = static_cast<float>(Rng(2).uniform(i));
      const auto level =
          static_cast<float>(options.alpha_min + (options.alpha_max - options.alpha_min) * Rng(3).uniform(i));
      const double reward = action + action * action * Rng(4).normal(i);
      replay.add({{&seen, 1}, {&action, 1}, {&level, 1}, {&seen, 1}, static_cast<float>(reward), true});
    }
  }
  void train(int updates) {
    for (int i = 0; i < updates; ++i) learner.update(replay);
  }
  /// The best action at a level: the mean over some more updates, for the policy trembles with its minibatches.
  std::vector<double> actions_at(const std::vector<float>& levels) {
    constexpr int kRounds = 100;
    std::vector<double> result(levels.size());
    for (int round = 0; round < kRounds; ++round) {
      train(40);
      ActorNetwork actor = learner.actor().network();
      for (std::size_t i = 0; i < levels.size(); ++i) {
        actor.alpha = levels[i];
        result[i] += ActorRunner(actor, 1).act(std::vector<float>{1.0f})[0] / static_cast<double>(kRounds);
      }
    }
    return result;
  }
};

}  // namespace

TEST_CASE("8.6.2 networks learn the moments of an endless stream, each loss its own") {
  struct Case {
    WcpgOptions options;
    double variance, within;
  };
  for (const Case& which :
       {Case{fixed_profile(), 5.263, 0.05}, Case{squared_wasserstein(), 4.849, 0.05}, Case{small(), 5.399, 0.15}}) {
    Chain chain(which.options, 0);

    chain.train(8'000);
    const ReturnLaw law = chain.law(0);

    CAPTURE(which.variance);
    CHECK(std::abs(law.mean / 10.0 - 1.0) < 0.01);
    CHECK(std::abs(law.variance() / which.variance - 1.0) < which.within);
  }
}

TEST_CASE("8.6.3 networks learn the moments of a chain of ten rewards, each loss its own") {
  struct Case {
    WcpgOptions options;
    double variance, within;
  };
  for (const Case& which : {Case{fixed_profile(), 4.623281, 0.05}, Case{squared_wasserstein(), 4.080886, 0.05},
                            Case{small(), 3.495433, 0.15}}) {
    Chain chain(which.options, 10);

    chain.train(12'000);
    const ReturnLaw law = chain.law(0);

    CAPTURE(which.variance);
    CHECK(std::abs(law.mean / 6.513216 - 1.0) < 0.01);
    CHECK(std::abs(law.variance() / which.variance - 1.0) < which.within);
  }
}

TEST_CASE("8.6.4 certain rewards have no variance, by the squared temporal difference") {
  Chain chain(fixed_profile(), 10, 0.0);

  chain.train(20'000);

  for (std::size_t state = 0; state < 10; ++state) CHECK(chain.law(state, 10).variance() < 1e-3);
}

// Not met yet, and so not run: the actions are off by up to 0.1. See docs/agents.md.
TEST_CASE("8.6.6 one conditional network finds the best action of every risk level" * doctest::skip()) {
  WcpgOptions options = fixed_profile();
  options.alpha_min = 0.05;
  options.hidden = 48;
  RiskBandit bandit(options);

  bandit.train(20'000);
  const std::vector<double> actions = bandit.actions_at({0.1f, 0.3f, 0.5f, 1.0f});

  CAPTURE(actions[0]);
  CAPTURE(actions[1]);
  CHECK(std::abs(actions[0] - 0.2849) < 0.06);
  CHECK(std::abs(actions[1] - 0.4314) < 0.06);
  CHECK(std::abs(actions[2] - 0.6267) < 0.06);
  CHECK(std::abs(actions[3] - 1.0) < 0.06);
}

TEST_CASE("8.6.6 the best action at a fixed risk level tells which variant was built" * doctest::skip()) {
  WcpgOptions literal = fixed_profile();
  literal.cvar_coef = "literal";
  struct Case {
    WcpgOptions options;
    double at_0_3, at_0_5;
  };
  for (const Case& which : {Case{fixed_profile(), 0.4314, 0.6267}, Case{squared_wasserstein(), 0.541, 0.785},
                            Case{small(), 0.63, 0.955}, Case{literal, 0.810, 0.982}}) {
    for (const double level : {0.3, 0.5}) {
      WcpgOptions options = which.options;
      options.alpha_min = options.alpha_max = level;
      RiskBandit bandit(options);

      bandit.train(8'000);

      CAPTURE(level);
      CAPTURE(which.at_0_3);
      const double action = bandit.actions_at({static_cast<float>(level)})[0];
      CAPTURE(action);
      CHECK(std::abs(action - (level == 0.3 ? which.at_0_3 : which.at_0_5)) < 0.04);
    }
  }
}

TEST_CASE("critics of returns are judged by the lesser risk, and its slope is that of finite differences") {
  WcpgOptions options = small();
  GaussianCritic critic(options, kShape, Rng(2));
  Tiles<float> input(kLanes, 3), slope(kLanes, 1), unused(kLanes, 1);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    for (std::size_t i = 0; i < 2; ++i) input.at(lane, i) = static_cast<float>(Rng(5).split(lane).normal(i));
    input.at(lane, 2) = static_cast<float>(0.1 + 0.9 * Rng(6).uniform(lane));
  }
  std::vector<float> value(kLanes), above(kLanes), below(kLanes);

  critic.judge(input, Rng(0), {value, slope});

  const auto first = critic.laws(0, input), second = critic.laws(1, input);
  constexpr float kStep = 1e-2f;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const double c = cvar_coefficient(input.at(lane, 2));
    CHECK(value[lane] == static_cast<float>(std::min(first[lane].cvar(c), second[lane].cvar(c))));
    input.at(lane, 1) += kStep;
  }
  critic.judge(input, Rng(0), {above, unused});
  for (std::size_t lane = 0; lane < kLanes; ++lane) input.at(lane, 1) -= 2 * kStep;
  critic.judge(input, Rng(0), {below, unused});
  int close = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    close += std::abs((above[lane] - below[lane]) / (2 * kStep) - slope.at(lane, 0)) < 2e-3;
  CHECK(close > static_cast<int>(kLanes) * 9 / 10);  // the lesser changes between some
}
