#pragma once

#include <optional>

#include "gust/agents/environments.h"
#include "gust/agents/learning_curve.h"
#include "gust/agents/off_policy_learner.h"

namespace gust {

/// Agents that act at a risk level: each episode of each environment draws its own, uniformly from low to high, and
/// keeps it. The level is the last input of actor and critics, and the one extra of a transition.
struct RiskLevels {
  double low = 0.01;
  double high = 1.0;
  double acts_at = 0.3;  ///< the level of the finished policy, unless it is told another
};

/// What makes an agent out of the frame below: its options, what tells it from others, its critics.
struct OffPolicySetup {
  OffPolicyOptions options;
  std::string identity;  ///< kind and all options, as text; a checkpoint of another is refused
  MakeCritic make_critic;
  std::optional<RiskLevels> risk = {};
  std::function<void(Minibatch&, Rng)> prepare = {};  ///< see OffPolicyLearner::prepare
};

/// A training from memory, the same for all such agents (docs/algorithms.md 2.1): environments stepped together, a
/// warm-up of random actions, every transition kept, pending updates done in bursts, a learning curve, checkpoints.
class OffPolicyTraining final : public Training {
 public:
  OffPolicyTraining(OffPolicySetup setup, const TrainingTask& task);

  /// Steps the environments until a burst of updates is due, and does it.
  void advance() override;
  bool done() const override { return steps_ >= total_steps() || !failure_.empty(); }
  std::int64_t steps() const override { return steps_; }
  std::int64_t total_steps() const override { return setup_.options.total_steps(); }
  const std::string& failure() const override { return failure_; }
  const std::vector<CurvePoint>& curve() const override { return curve_.points(); }
  ActorNetwork actor() const override;
  std::string save() const override;
  void load(std::string_view bytes) override;

  OffPolicyLearner& learner() { return learner_; }
  const Replay& replay() const { return replay_; }

 private:
  OffPolicyTraining(OffPolicySetup setup, const TrainingTask& task, Rng rng);

  void step();
  void see();
  void remember();
  void draw_level(std::size_t lane);
  void pay_updates();
  std::string identity() const { return cat("gust off-policy 1 ", setup_.identity, " seed ", seed_); }

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    archive.number(self.steps_);
    archive.number(self.owed_);
    archive.text(self.failure_);
    archive.block(std::span(self.level_));
    archive.block(std::span(self.episodes_));
    LearningCurve::archive(archive, self.curve_);
  }

  OffPolicySetup setup_;
  std::int64_t seed_;
  Rng rng_;
  Environments environments_;
  TransitionShape shape_;
  OffPolicyLearner learner_;
  Replay replay_;
  LearningCurve curve_;
  std::int64_t steps_ = 0;
  double owed_ = 0;  // updates that are due
  std::string failure_;
  std::vector<double> level_;            // of each environment's episode
  std::vector<std::uint64_t> episodes_;  // of each environment so far: numbers the levels

  Buffer<float> seen_;    // environments x actor's inputs: before the step
  Buffer<float> action_;  // environments x actions
  Buffer<float> next_;    // of one environment
  Matrix<double> command_;
};

/// The bytes that a training's memory takes when it is full.
std::uint64_t replay_bytes(const OffPolicyOptions& options, const PlantSpec& spec, bool risk);

}  // namespace gust
