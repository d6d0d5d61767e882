#pragma once

#include "gust/core/fields.h"

namespace gust {

/// What all agents that learn from a replay buffer share: soft actor-critic (Haarnoja et al. 2018), and what is
/// built on it. The defaults are those of safe-control-gym (docs/algorithms.md 2.1).
struct OffPolicyOptions {
  std::int64_t steps = 1'000'000;
  std::int64_t environments = 4;
  std::int64_t hidden = 256;
  std::int64_t layers = 2;
  std::string activation = "relu";
  std::string actor_trunk = "relu";
  std::string density = "box";
  double discount = 0.99;
  std::int64_t batch = 64;
  std::int64_t buffer = 1'000'000;
  std::int64_t warm_up = 1000;
  double update_ratio = 1.0;
  std::int64_t burst = 100;
  double polyak = 0.005;
  double temperature = 0.2;
  bool auto_temperature = false;
  double target_entropy = -1.0;
  double actor_rate = 1e-3;
  double critic_rate = 1e-3;
  double temperature_rate = 1e-3;
  double adam_epsilon = 1e-8;
  std::string sac_order = "upstream";

  static constexpr std::tuple kFields = {
      field("steps", &OffPolicyOptions::steps,
            "environment steps of the training, rounded up to whole steps of all environments", between(1, 1e12)),
      field("environments", &OffPolicyOptions::environments, "environments stepped together", between(1, 4096)),
      field("hidden", &OffPolicyOptions::hidden, "width of the hidden layers", between(1, 4096)),
      field("layers", &OffPolicyOptions::layers, "hidden layers of actor and critics", between(1, 8)),
      field("activation", &OffPolicyOptions::activation, "of the hidden layers", one_of("tanh|relu|leaky_relu")),
      field("discount", &OffPolicyOptions::discount, "of future rewards, per step", between(0, 1)),
      field("batch", &OffPolicyOptions::batch, "transitions an update, drawn with replacement", between(1, 65'536)),
      field("buffer", &OffPolicyOptions::buffer, "transitions that the memory holds; then the oldest go",
            between(1, 1e12)),
      field("warm_up", &OffPolicyOptions::warm_up,
            "environment steps of uniformly random actions before learning begins", non_negative),
      field("update_ratio", &OffPolicyOptions::update_ratio,
            "updates an environment step after the warm-up; a fraction is kept and owed", between(0, 1000)),
      field("burst", &OffPolicyOptions::burst, "updates done together, as soon as so many are owed",
            between(1, 1'000'000)),
      field("polyak", &OffPolicyOptions::polyak, "share by which the target networks follow the critics, each update",
            Range{.low = 0, .high = 1, .low_open = true}),
      field("temperature", &OffPolicyOptions::temperature,
            "weight of the entropy against the reward; where it is automatic, its first value", positive),
      field("auto_temperature", &OffPolicyOptions::auto_temperature,
            "moves the temperature so that the policy keeps the target entropy"),
      field("target_entropy", &OffPolicyOptions::target_entropy,
            "that an automatic temperature holds, per action, of actions in the policy's unit", between(-100, 100)),
      field("actor_rate", &OffPolicyOptions::actor_rate, "Adam's rate for the actor", positive),
      field("critic_rate", &OffPolicyOptions::critic_rate, "Adam's rate for the critics", positive),
      field("temperature_rate", &OffPolicyOptions::temperature_rate, "Adam's rate for the temperature's logarithm",
            positive),
      field("adam_epsilon", &OffPolicyOptions::adam_epsilon, "Adam's epsilon, outside the square root", positive),
      field("sac_order", &OffPolicyOptions::sac_order,
            "upstream: actor, temperature, critics with the new actor (safe-control-gym); original: critics, "
            "temperature, actor",
            one_of("upstream|original")),
      later(
          field("actor_trunk", &OffPolicyOptions::actor_trunk,
                "scg: no activation after the actor's last hidden layer, as in safe-control-gym; relu: one after each",
                one_of("relu|scg"))),
      later(field("density", &OffPolicyOptions::density,
                  "whose entropy the temperature weighs: of actions in the box, or of their tanh alone, as in "
                  "safe-control-gym; the same where actions are -1 to 1",
                  one_of("box|tanh"))),
  };

  void check(const Place& place) const {
    if (batch > buffer) throw error_at(place, "'batch' must be at most 'buffer' = ", buffer, ", got ", batch);
    if (actor_trunk == "scg" && layers < 2)
      throw error_at(place, "'actor_trunk' scg needs at least 2 'layers': an actor without an activation is linear");
    if (burst > buffer) throw error_at(place, "'burst' must be at most 'buffer' = ", buffer, ", got ", burst);
  }

  /// Floating-point operations a step: an update is worth sixteen passes of a minibatch through one network.
  double work() const {
    const auto width = static_cast<double>(hidden);
    const double weights = width * width * static_cast<double>(layers - 1) + 12 * width;
    return 32 * weights * static_cast<double>(batch) * update_ratio;
  }

  std::int64_t total_steps() const { return (steps + environments - 1) / environments * environments; }
};

}  // namespace gust
