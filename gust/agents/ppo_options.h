#pragma once

#include "gust/agents/rollout.h"
#include "gust/core/fields.h"

namespace gust {

/// Proximal policy optimisation (Schulman et al. 2017); the defaults are those of safe-control-gym
/// (docs/algorithms.md 1.1).
struct PpoOptions {
  std::int64_t steps = 1'000'000;
  std::int64_t environments = 4;
  std::int64_t rollout = 100;
  std::int64_t epochs = 10;
  std::int64_t minibatch = 64;
  std::int64_t hidden = 64;
  std::int64_t layers = 2;
  std::string activation = "tanh";
  std::string init = "uniform";
  double log_std = -0.5;
  double discount = 0.99;
  bool use_gae = false;
  double lambda = 0.95;
  std::string value_target = "return";
  std::string advantage_scale = "rollout";
  double clip = 0.2;
  double value_clip = 0;
  double target_kl = 0.01;
  double entropy = 0.01;
  double actor_rate = 3e-4;
  double critic_rate = 1e-3;
  std::string rate_decay = "none";
  double adam_epsilon = 1e-8;
  double max_grad_norm = 0;
  bool normalise_observation = false;
  bool normalise_reward = false;

  static constexpr std::tuple kFields = {
      field("steps", &PpoOptions::steps, "environment steps of the training, rounded up to whole rollouts",
            between(1, 1e12)),
      field("environments", &PpoOptions::environments, "environments stepped together", between(1, 4096)),
      field("rollout", &PpoOptions::rollout, "steps of each environment between two updates", between(1, 1'000'000)),
      field("epochs", &PpoOptions::epochs, "passes over a rollout", between(1, 10'000)),
      field("minibatch", &PpoOptions::minibatch,
            "samples a gradient step; what is left of a pass after whole minibatches is dropped",
            between(1, 1'000'000)),
      field("hidden", &PpoOptions::hidden, "width of the hidden layers", between(1, 4096)),
      field("layers", &PpoOptions::layers, "hidden layers of actor and critic", between(1, 8)),
      field("activation", &PpoOptions::activation, "of the hidden layers", one_of("tanh|relu|leaky_relu")),
      field("init", &PpoOptions::init,
            "uniform: weights and biases U(±1/sqrt(fan in)); orthogonal: gains sqrt 2, 0.01 (policy) and 1 (value)",
            one_of("uniform|orthogonal")),
      field("log_std", &PpoOptions::log_std, "initial logarithm of the policy's standard deviation", between(-20, 20)),
      field("discount", &PpoOptions::discount, "of future rewards, per step", between(0, 1)),
      field("use_gae", &PpoOptions::use_gae, "generalised advantage estimation; else return minus value"),
      field("lambda", &PpoOptions::lambda, "of the generalised advantage estimation", between(0, 1)),
      field("value_target", &PpoOptions::value_target,
            "return: the discounted return even with use_gae; td_lambda: advantage plus value",
            one_of("return|td_lambda")),
      field("advantage_scale", &PpoOptions::advantage_scale, "over what advantages are standardised",
            one_of("rollout|minibatch")),
      field("clip", &PpoOptions::clip, "the ratio of densities is clipped to 1 ± clip", positive),
      field("value_clip", &PpoOptions::value_clip, "how far a value counts as moved from its old one; 0 is off",
            non_negative),
      field("target_kl", &PpoOptions::target_kl,
            "a minibatch whose divergence is above 1.5 times this moves the critic only; 0 is off", non_negative),
      field("entropy", &PpoOptions::entropy, "weight of the policy's entropy in the loss", non_negative),
      field("actor_rate", &PpoOptions::actor_rate, "Adam's rate for the actor", positive),
      field("critic_rate", &PpoOptions::critic_rate, "Adam's rate for the critic", positive),
      field("rate_decay", &PpoOptions::rate_decay, "linear: both rates fall to zero over the training",
            one_of("none|linear")),
      field("adam_epsilon", &PpoOptions::adam_epsilon, "Adam's epsilon, outside the square root", positive),
      field("max_grad_norm", &PpoOptions::max_grad_norm, "bound of each optimiser's gradient norm; 0 is off",
            non_negative),
      field("normalise_observation", &PpoOptions::normalise_observation,
            "scale observations by their running mean and deviation; the final policy has it in its first layer"),
      field("normalise_reward", &PpoOptions::normalise_reward,
            "scale rewards by the running deviation of the discounted return"),
  };

  void check(const Place& place) const {
    if (minibatch > environments * rollout) {
      throw error_at(place, "'minibatch' must be at most environments * rollout = ", environments * rollout, ", got ",
                     minibatch);
    }
    if (environments * rollout > 10'000'000) {
      throw error_at(place, "environments * rollout must be at most 10000000, got ", environments * rollout);
    }
  }

  ReturnOptions returns() const { return {discount, lambda, use_gae, value_target == "td_lambda"}; }
  std::int64_t samples() const { return environments * rollout; }

  /// Floating-point operations a step: each sample passes actor and critic once, and three times as much an epoch.
  double work() const {
    const auto width = static_cast<double>(hidden);
    const double weights = width * width * static_cast<double>(layers - 1) + 12 * width;
    return 4 * weights * (1 + 3 * static_cast<double>(epochs));
  }
};

}  // namespace gust
