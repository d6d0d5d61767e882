#include "gust/agents/gaussian_critic.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <utility>

#include "gust/agents/risk_bandit_test.h"

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
  options.variance_loss = "divergence";
  return options;
}
WcpgOptions unbiased() {
  WcpgOptions options = fixed_profile();
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
      critic.update({batch, density, 0.0, rng});
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

}  // namespace

TEST_CASE("8.6.2 networks learn the moments of an endless stream, each loss its own") {
  struct Case {
    WcpgOptions options;
    double variance, within;
  };
  for (const Case& which : {Case{fixed_profile(), 5.263, 0.05}, Case{unbiased(), 5.263, 0.05},
                            Case{squared_wasserstein(), 4.849, 0.05}, Case{small(), 5.399, 0.15}}) {
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
  for (const Case& which : {Case{fixed_profile(), 4.623281, 0.05}, Case{unbiased(), 4.623281, 0.05},
                            Case{squared_wasserstein(), 4.080886, 0.05}, Case{small(), 3.495433, 0.15}}) {
    Chain chain(which.options, 10);

    chain.train(24'000);
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

TEST_CASE("8.6.6 one conditional network finds the best action of every risk level, each variant its own") {
  WcpgOptions literal = fixed_profile();
  literal.cvar_coef = "literal";
  struct Case {
    WcpgOptions options;
    std::array<double, 4> best;
  };
  for (const Case& which :
       {Case{fixed_profile(), {0.2849, 0.4314, 0.6267, 1.0}}, Case{unbiased(), {0.2849, 0.4314, 0.6267, 1.0}},
        Case{squared_wasserstein(), {0.357, 0.541, 0.785, 1.0}}, Case{small(), {0.33, 0.63, 0.955, 1.0}},
        Case{literal, {0.680, 0.810, 0.982, 1.0}}}) {
    WcpgOptions options = which.options;
    options.alpha_min = 0.05;
    RiskBandit<GaussianCritic, WcpgOptions> bandit(options, kShape, {options.alpha_min, 1.0});

    bandit.train(40'000);

    CAPTURE(options.variance_target);
    CAPTURE(options.variance_loss);
    CAPTURE(options.cvar_coef);
    constexpr std::array<double, 4> kLevels = {0.1, 0.3, 0.5, 1.0};
    for (std::size_t i = 0; i < kLevels.size(); ++i) {
      CAPTURE(kLevels[i]);
      CHECK(std::abs(bandit.action(kLevels[i]) - which.best[i]) < 0.04);
    }
  }
}

TEST_CASE("8.6.6 networks of one risk level find its best action") {
  for (const auto& [level, best] : {std::pair{0.1, 0.2849}, {0.3, 0.4314}, {0.5, 0.6267}, {1.0, 1.0}}) {
    WcpgOptions options = fixed_profile();
    options.alpha_min = options.alpha_max = level;
    RiskBandit<GaussianCritic, WcpgOptions> bandit(options, kShape, {level, level});

    bandit.train(30'000);

    CAPTURE(level);
    CHECK(std::abs(bandit.action(level) - best) < 0.04);
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
