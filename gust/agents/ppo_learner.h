#pragma once

#include "gust/agents/ppo_loss.h"
#include "gust/agents/ppo_options.h"
#include "gust/agents/rollout.h"
#include "gust/core/rng.h"
#include "gust/nn/adam.h"
#include "gust/nn/mlp.h"

namespace gust {

/// A network with what moves it.
struct TrainedNetwork {
  TrainedNetwork(const MlpShape& shape, std::size_t lanes)
      : mlp(shape), workspace(shape, lanes), gradient(mlp.parameters().size()), adam(gradient.size()) {}

  Mlp<float> mlp;
  MlpWorkspace<float> workspace;
  Buffer<float> gradient;
  AdamState<float> adam;
};

template <class Archive, class Adam>
void archive_adam(Archive& archive, Adam& state) {
  archive.block(std::span(state.first));
  archive.block(std::span(state.second));
  archive.number(state.beta1_power);
  archive.number(state.beta2_power);
}

template <class Archive, class Network>
void archive_network(Archive& archive, Network& network) {
  archive.block(network.mlp.parameters());
  archive_adam(archive, network.adam);
}

/// What one gradient step did.
struct PpoStep {
  PolicyLoss policy;
  double value_loss = 0;
  bool actor_moved = false;  ///< false where the divergence was too large
};

/// A stochastic actor and a critic that learn from rollouts (docs/algorithms.md 1): what PPO trains, and each side of
/// an adversarial training.
class PpoLearner {
 public:
  PpoLearner(const PpoOptions& options, std::size_t observations, std::size_t actions, Rng rng);

  const Mlp<float>& actor() const { return actor_.mlp; }
  const Mlp<float>& critic() const { return critic_.mlp; }
  std::span<const float> log_std() const { return log_std_; }
  bool finite() const;
  /// Gradient steps so far.
  std::int64_t actor_steps() const { return actor_steps_; }
  std::int64_t critic_steps() const { return critic_steps_; }

  /// Writes the observations' mean actions and draws actions around them, for one step of all environments, from the
  /// rollout's sample on. Draw number `step` of each environment's own stream.
  void sample(Rollout& rollout, std::size_t sample, std::uint64_t step);

  /// Fills in densities, values, targets and advantages of a whole rollout. No sample's numbers enter those of another
  /// environment or episode.
  void evaluate(Rollout& rollout);
  /// The same, with the advantages standardised over all samples if that is how the options want them.
  void assess(Rollout& rollout);

  /// All epochs of minibatches over a rollout that was assessed; returns the last gradient step's outcome. `progress`
  /// is the share of the training that is done.
  PpoStep update(const Rollout& rollout, double progress);
  /// The same over some of its samples alone; nothing happens if they are fewer than a minibatch.
  PpoStep update(const Rollout& rollout, std::span<const std::uint32_t> samples, double progress);

  /// One gradient step of the critic, and of the actor unless it has moved too far, on some samples.
  PpoStep step(const Rollout& rollout, std::span<const std::uint32_t> samples, double progress);

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    archive_network(archive, self.actor_);
    archive_network(archive, self.critic_);
    archive.block(std::span(self.log_std_));
    archive_adam(archive, self.log_std_adam_);
    archive.number(self.epochs_);
    archive.number(self.actor_steps_);
    archive.number(self.critic_steps_);
  }

 private:
  void gather(const Rollout& rollout, std::span<const std::uint32_t> samples);
  void move_actor(std::span<const float> mean, double progress);
  void values_of(std::span<const float> observations, std::span<float> values);
  AdamOptions adam_options(double rate, double progress) const;

  PpoOptions options_;
  Rng rng_;
  TrainedNetwork actor_;
  TrainedNetwork critic_;
  Buffer<float> log_std_;
  Buffer<float> log_std_gradient_;
  AdamState<float> log_std_adam_;
  std::uint64_t epochs_ = 0;  // done so far: numbers the permutations
  std::int64_t actor_steps_ = 0;
  std::int64_t critic_steps_ = 0;

  // Of the minibatch at hand.
  std::vector<std::uint32_t> order_;
  Buffer<float> observation_, action_, old_log_density_, old_value_, advantage_, target_;
  Buffer<float> log_density_, at_log_density_, at_mean_, at_value_;
  std::vector<double> minibatch_advantage_;
};

/// Puts 0 … size-1 into a random order (Fisher and Yates).
void shuffle(std::span<std::uint32_t> order, Rng rng);

/// The shape of a network of these options.
MlpShape ppo_shape(const PpoOptions& options, std::size_t inputs, std::size_t outputs);

}  // namespace gust
