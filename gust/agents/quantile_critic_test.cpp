#include "gust/agents/quantile_critic.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "gust/agents/cvar.h"
#include "gust/agents/risk_bandit_test.h"

using namespace gust;

namespace {

constexpr TransitionShape kShape{.observations = 1, .actions = 1};

RaacOptions small(double kappa, double alpha = 0.3) {
  RaacOptions options;
  options.hidden = 32;
  options.head = 16;
  options.kappa = kappa;
  options.alpha = alpha;
  options.temperature = 1e-3;
  options.target_fractions = 1;  // nothing follows: all targets of a sample are its reward
  return options;
}

/// Critics that learn the law of a reward, whatever is done.
struct LearnedLaw {
  RaacOptions options;
  QuantileCritic critic;
  std::function<double(Rng, std::uint64_t)> reward;
  Minibatch batch;
  std::uint64_t updates = 0;

  LearnedLaw(const RaacOptions& given, std::function<double(Rng, std::uint64_t)> draw)
      : options(given),
        critic(given, kShape, Rng(3)),
        reward(std::move(draw)),
        batch(kShape, static_cast<std::size_t>(given.batch)) {}

  void train(int count) {
    const std::vector<float> density(batch.lanes(), 0.0f);
    for (int i = 0; i < count; ++i, ++updates) {
      const Rng rng = Rng(8).split(updates);
      for (std::size_t lane = 0; lane < batch.lanes(); ++lane)
        batch.reward[lane] = static_cast<float>(reward(rng, lane));
      critic.update({batch, density, 0.0, rng});
    }
  }

  /// Quantiles at some fractions: the mean of both critics over some more updates.
  std::vector<double> quantiles(const std::vector<float>& fractions) {
    constexpr int kRounds = 100;
    const QuantileShape shape{.inputs = 2, .hidden = 32, .head = 16};
    QuantileRunner<float> runner(shape, {1, fractions.size()}, {});
    const Tiles<float> input(1, 2);
    std::vector<double> result(fractions.size());
    for (int round = 0; round < kRounds; ++round) {
      train(10);
      for (const std::size_t which : {0u, 1u}) {
        const Tiles<float>& z = runner.forward(critic.network(which), input, {.shared = fractions});
        for (std::size_t i = 0; i < fractions.size(); ++i) result[i] += z.at(0, i) / (2.0 * kRounds);
      }
    }
    return result;
  }

  /// The mean of the quantiles below a level.
  double risk(double level) {
    std::vector<float> fractions;
    for (int i = 0; i < 50; ++i) fractions.push_back(static_cast<float>(level * (i + 0.5) / 50));
    double sum = 0.0;
    for (const double quantile : quantiles(fractions)) sum += quantile / 50;
    return sum;
  }
};

double normal_reward(Rng rng, std::uint64_t i) { return rng.normal(i); }

/// One step, one action in `box`, whose reward is drawn; actions of the memory are uniform in the box.
struct Bandit {
  OffPolicyLearner learner;
  Replay replay{kShape, 40'000};

  Bandit(const RaacOptions& options, const ActionBox& box, const std::function<double(double, Rng)>& reward)
      : learner(
            options, kShape, box,
            [options](const OffPolicyOptions&, const TransitionShape& shape, Rng rng) {
              return std::make_unique<QuantileCritic>(options, shape, rng);
            },
            Rng(1)) {
    const float seen = 1.0f;
    for (std::uint64_t i = 0; i < 40'000; ++i) {
      const auto action = static_cast<float>(box.centre[0] + box.half_width[0] * (2.0 * Rng(2).uniform(i) - 1.0));
      const auto gain = static_cast<float>(reward(action, Rng(4).split(i)));
      replay.add({{&seen, 1}, {&action, 1}, {}, {&seen, 1}, gain, true});
    }
  }
  double action_after(int updates) {
    constexpr int kRounds = 100;  // the mean over the last of them, for the policy trembles with its minibatches
    double sum = 0.0;
    for (int i = 0; i < updates; ++i) learner.update(replay);
    for (int round = 0; round < kRounds; ++round) {
      for (int i = 0; i < 30; ++i) learner.update(replay);
      sum += ActorRunner(learner.actor().network(), 1).act(std::vector<float>{1.0f})[0];
    }
    return sum / kRounds;
  }
};

}  // namespace

TEST_CASE("8.7.2 the quantiles of a bandit are learned for a small kappa, and the table's numbers for kappa 1") {
  const std::vector<float> fractions = {0.05f, 0.1f, 0.25f, 0.5f, 0.9f};
  const std::vector<double> truth = {-1.6449, -1.2816, -0.6745, 0.0, 1.2816};
  const std::vector<double> biased = {-1.3087, -0.9930, -0.5049, 0.0, 0.9930};
  for (const double kappa : {0.01, 1.0}) {
    LearnedLaw law(small(kappa), normal_reward);

    law.train(4'000);
    const std::vector<double> learned = law.quantiles(fractions);

    for (std::size_t i = 0; i < fractions.size(); ++i) {
      CAPTURE(kappa);
      CAPTURE(fractions[i]);
      CHECK(std::abs(learned[i] - (kappa == 1.0 ? biased : truth)[i]) < 0.06);
    }
  }
}

TEST_CASE("8.7.3 the conditional value at risk of known laws is learned") {
  struct Case {
    std::function<double(Rng, std::uint64_t)> draw;
    double at_0_1, at_0_3, at_0_5, within;
  };
  const auto uniform = [](Rng rng, std::uint64_t i) { return rng.uniform(i); };
  const auto exponential = [](Rng rng, std::uint64_t i) { return -std::log(1.0 - rng.uniform(i)); };
  for (const Case& which :
       {Case{uniform, 0.05, 0.15, 0.25, 0.03}, Case{exponential, 0.051755, 0.167758, 0.306853, 0.03},
        Case{normal_reward, -cvar_coefficient(0.1), -cvar_coefficient(0.3), -cvar_coefficient(0.5), 0.06}}) {
    LearnedLaw law(small(0.01), which.draw);

    law.train(4'000);

    CAPTURE(which.at_0_3);
    CHECK(std::abs(law.risk(0.1) - which.at_0_1) < which.within);
    CHECK(std::abs(law.risk(0.3) - which.at_0_3) < which.within);
    CHECK(std::abs(law.risk(0.5) - which.at_0_5) < which.within);
  }
}

TEST_CASE("8.7.4 the best action of the risk bandit is found at every level") {
  struct Case {
    double level, best;
  };
  for (const Case& which : {Case{0.1, 0.2849}, Case{0.3, 0.4314}, Case{0.5, 0.6267}, Case{1.0, 1.0}}) {
    RaacOptions options = small(0.02 * 10.0, which.level);
    options.stratified = true;
    RiskBandit<QuantileCritic, RaacOptions> bandit(options, kShape, {});

    bandit.train(14'000);

    CAPTURE(which.level);
    CHECK(std::abs(bandit.action(which.level) - which.best) < 0.05);
  }
}

TEST_CASE("8.7.5 of a safe arm and a better one that may fail, the level decides") {
  for (const double level : {1.0, 0.1}) {
    // Below zero arm A pays 0.6 surely; above, B pays 1 or, once in twenty, -3.
    Bandit bandit(small(0.05, level), {{0.0f}, {1.0f}}, [](double a, Rng rng) {
      return a < 0.0 ? 0.6 : rng.uniform(0) < 0.95 ? 1.0 : -3.0;
    });

    const double action = bandit.action_after(6'000);

    CAPTURE(level);
    CAPTURE(action);
    CHECK((level == 1.0 ? action > 0.0 : action < 0.0));
  }
}

TEST_CASE("8.7.8 the published factor of one over alpha is a temperature times alpha") {
  RaacOptions plain = small(1.0, 0.5), factor = plain;
  factor.raac_inv_alpha = true;
  QuantileCritic a(plain, kShape, Rng(3)), b(factor, kShape, Rng(3));
  Tiles<float> input(64, 2), slope_a(64, 1), slope_b(64, 1);
  for (std::size_t lane = 0; lane < 64; ++lane)
    for (std::size_t i = 0; i < 2; ++i) input.at(lane, i) = static_cast<float>(Rng(5).split(lane).normal(i));
  std::vector<float> value_a(64), value_b(64);

  a.judge(input, Rng(7), {value_a, slope_a});
  b.judge(input, Rng(7), {value_b, slope_b});

  // With alpha a power of two every number is scaled exactly.
  std::vector<double> mean(64), log_std(64), noise(64), scaled(64), unscaled(64);
  std::vector<double> at_a(64), at_b(64);
  for (std::size_t lane = 0; lane < 64; ++lane) {
    CHECK(value_b[lane] == value_a[lane] / 0.5f);
    CHECK(slope_b.at(lane, 0) == slope_a.at(lane, 0) / 0.5f);
    mean[lane] = Rng(8).normal(lane);
    noise[lane] = Rng(9).normal(lane);
    at_a[lane] = -slope_a.at(lane, 0);
    at_b[lane] = -slope_b.at(lane, 0);
  }
  const std::vector<float> centre = {0.0f}, half_width = {1.0f};
  const SquashedGaussian<double> policy{mean, log_std, centre, half_width};
  const auto gradient = [&](const std::vector<double>& at_action, double temperature, std::vector<double>& to) {
    std::vector<double> at_density(64, temperature), unused(64);
    squashed_gradient<double>(policy, noise, {at_action, at_density}, {to, unused});
  };
  gradient(at_a, 0.5 * 0.2, unscaled);
  gradient(at_b, 0.2, scaled);
  for (std::size_t lane = 0; lane < 64; ++lane) CHECK(scaled[lane] == unscaled[lane] / 0.5);
}

TEST_CASE("a critic's slope at the actions is that of its risk, for one critic or two, shared fractions or own") {
  for (const bool own : {false, true}) {
    for (const std::int64_t critics : {1, 2}) {
      RaacOptions options = small(1.0);
      options.activation = "tanh";
      options.critics = critics;
      options.stratified = own;
      options.fraction_sets = own ? "own" : "shared";
      QuantileCritic critic(options, kShape, Rng(3));
      Tiles<float> input(64, 2), slope(64, 1), unused(64, 1);
      for (std::size_t lane = 0; lane < 64; ++lane)
        for (std::size_t i = 0; i < 2; ++i) input.at(lane, i) = static_cast<float>(Rng(5).split(lane).normal(i));
      std::vector<float> value(64), above(64), below(64);
      constexpr float kStep = 1e-2f;

      critic.judge(input, Rng(7), {value, slope});
      for (std::size_t lane = 0; lane < 64; ++lane) input.at(lane, 1) += kStep;
      critic.judge(input, Rng(7), {above, unused});
      for (std::size_t lane = 0; lane < 64; ++lane) input.at(lane, 1) -= 2 * kStep;
      critic.judge(input, Rng(7), {below, unused});

      int close = 0;
      for (std::size_t lane = 0; lane < 64; ++lane)
        close += std::abs((above[lane] - below[lane]) / (2 * kStep) - slope.at(lane, 0)) < 1e-3;
      CHECK(close >= 60);  // the lesser changes between some
    }
  }
}
