#pragma once

#include <array>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "gust/agents/agent.h"
#include "gust/agents/off_policy_learner.h"

namespace gust {

/// Point i of a sequence that fills the unit cube evenly (Roberts 2018).
inline std::array<double, 3> evenly(std::uint64_t i) {
  constexpr double kRatio = 1.2207440846057596;  // the root of x^4 = x + 1
  std::array<double, 3> point;
  double step = 1.0;
  for (double& x : point) {
    step /= kRatio;
    const double turns = 0.5 + static_cast<double>(i) * step;
    x = turns - std::floor(turns);
  }
  return point;
}

/// One step, an action a in 0 … 1, reward 10 N(a, a^4): the best action at a level is 1 / (2 c), or 1
/// (docs/algorithms.md 8.6.6), whatever the unit of reward. In tens no deviation that matters lies where softplus has
/// hardly a slope.
///
/// Actions, levels and quantiles of the rewards fill the memory evenly, so that what it holds is the law itself and no
/// sample of it. The second half of a training is at a tenth of the rates, for a critic that trembles is wrong by the
/// square of it.
template <class Critic, class Options>
struct RiskBandit {
  static constexpr double kUnit = 10.0;
  static constexpr std::int64_t kMemory = 1'000'000;

  Options options;
  TransitionShape shape;
  Replay replay;
  ActorNetwork actor;

  /// Transitions carry a level if the shape has room for one.
  RiskBandit(const Options& given, const TransitionShape& of, LevelRange levels)
      : options(given), shape(of), replay(of, kMemory) {
    options.activation = "tanh";  // the variance bends as a^4, and few straight pieces do not
    options.temperature *= kUnit;
    options.critic_rate = 2e-3;
    const boost::math::normal standard;
    const float seen = 1.0f;
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(kMemory); ++i) {
      const auto [quantile, at_action, at_level] = evenly(i);
      const auto action = static_cast<float>(at_action);
      const auto level = static_cast<float>(levels.low + (levels.high - levels.low) * at_level);
      const double reward = kUnit * (action + action * action * boost::math::quantile(standard, quantile));
      replay.add({{&seen, 1}, {&action, 1}, {&level, shape.extras}, {&seen, 1}, static_cast<float>(reward), true});
    }
  }

  void train(int updates) {
    OffPolicyLearner fast = learner(options);
    for (int i = 0; i < updates / 2; ++i) fast.update(replay);
    Options rest = options;
    rest.actor_rate /= 10.0;
    rest.critic_rate /= 10.0;
    OffPolicyLearner slow = learner(rest);
    Saver saver;
    fast.save(saver);
    const std::string state = saver.take();
    Loader loader(state);
    slow.load(loader);
    for (int i = 0; i < updates / 2; ++i) slow.update(replay);
    actor = slow.actor().network();
  }

  /// What the trained policy does; the level is for one that is told it.
  double action(double level) {
    if (shape.extras > 0) actor.alpha = static_cast<float>(level);
    return ActorRunner(actor, 1).act(std::vector<float>{1.0f})[0];
  }

 private:
  OffPolicyLearner learner(const Options& with) const {
    const auto make_critic = [with](const OffPolicyOptions&, const TransitionShape& of, Rng rng) {
      return std::make_unique<Critic>(with, of, rng);
    };
    const char* seed = std::getenv("GUST_BANDIT_SEED");  // another one shows that it is no luck
    return {with, shape, {{0.5f}, {0.5f}}, make_critic, Rng(seed == nullptr ? 1 : std::strtoull(seed, nullptr, 10))};
  }
};

}  // namespace gust
