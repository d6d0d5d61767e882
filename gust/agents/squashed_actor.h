#pragma once

#include "gust/agents/off_policy_options.h"
#include "gust/core/rng.h"
#include "gust/nn/actor_network.h"
#include "gust/nn/squashed_gaussian.h"
#include "gust/nn/trained_mlp.h"
#include "gust/sim/plant.h"

namespace gust {

/// The box that a policy acts in, in its own unit: -1 … 1 where the plant takes normalised actions, else the actuator's
/// bounds.
ActionBox action_box(const PlantSpec& spec);

/// The shape of a network of these options.
MlpShape off_policy_shape(const OffPolicyOptions& options, std::size_t inputs, std::size_t outputs);

/// A stochastic actor: one network with a mean and a logarithm of the deviation for every action, squashed into a box
/// (nn/squashed_gaussian.h).
class SquashedActor {
 public:
  /// `inputs` numbers are seen: the observation, and what a transition carries besides.
  SquashedActor(const OffPolicyOptions& options, std::size_t inputs, ActionBox box, Rng rng);

  std::size_t inputs() const { return network_.mlp().shape().inputs(); }
  std::size_t actions() const { return box_.centre.size(); }
  const ActionBox& box() const { return box_; }
  bool finite() const { return network_.finite(); }

  /// Draws actions of a step of all environments: from lanes x inputs to lanes x actions, the numbers of a lane side by
  /// side. Lane e takes draws step x actions … of its own stream.
  void act(std::span<const float> input, std::uint64_t step, std::span<float> action);

  /// The same, uniformly in the box, whatever is seen.
  void act_randomly(std::uint64_t step, std::span<float> action) const;

  /// Draws an action for every lane of a batch, and writes it into features `at` on of another batch.
  void propose(const Tiles<float>& input, Rng rng, std::size_t at, Tiles<float>& into);
  /// Of the actions proposed last, per lane.
  std::span<const float> log_density() const { return log_density_; }

  /// One step that lowers mean(temperature log density - value), from the value's gradient at the actions proposed
  /// last.
  void improve(const Tiles<float>& value_at_action, double temperature);

  /// The deterministic actor: centre + half_width tanh(mean). A layer that is linear is joined with the one above it.
  ActorNetwork network() const;

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    TrainedMlp<float>::archive(archive, self.network_);
  }

 private:
  SquashedGaussian<float> policy(const Tiles<float>& heads, std::size_t tile) const;

  AdamOptions adam_;
  ActionBox box_;
  bool density_of_tanh_;
  Rng rng_;
  TrainedMlp<float> network_;
  MlpWorkspace<float> stepping_;
  const Tiles<float>* heads_ = nullptr;
  Tiles<float> noise_;
  Tiles<float> at_action_;
  Tiles<float> at_heads_;
  Buffer<float> log_density_;     // of whole tiles
  Buffer<float> at_log_density_;  // of a tile
};

}  // namespace gust
