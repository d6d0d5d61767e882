#pragma once

#include "gust/agents/collector.h"
#include "gust/agents/learning_curve.h"
#include "gust/agents/ppo_learner.h"

namespace gust {

/// What PPO and its adversarial relatives share: a protagonist that learns from rollouts, its learning curve, the state
/// as bytes, and an end where numbers are not finite.
class PpoTraining : public Training {
 public:
  void advance() final;
  bool done() const final { return steps_ >= total_steps_ || !failure_.empty(); }
  std::int64_t steps() const final { return steps_; }
  std::int64_t total_steps() const final { return total_steps_; }
  const std::string& failure() const final { return failure_; }
  const std::vector<CurvePoint>& curve() const final { return curve_.points(); }
  ActorNetwork actor() const final { return as_seen(protagonist_.actor()); }
  std::string save() const final;
  void load(std::string_view bytes) final;

  const PpoLearner& protagonist() const { return protagonist_; }
  /// The last one.
  const Rollout& rollout() const { return rollout_; }

 protected:
  struct Kind {
    std::string identity;                       ///< of the agent and its options, with their version
    std::optional<AdversarySite> against = {};  ///< where an adversary acts, if there is one
    std::int64_t rollouts = 1;                  ///< the training ends after a multiple of so many
  };

  PpoTraining(const PpoOptions& options, const TrainingTask& task, const Kind& kind);

  /// One rollout and what is learned from it; `progress` is the share of the training that is done.
  virtual void iterate(double progress) = 0;
  /// Steps that the protagonist has learned from.
  virtual std::int64_t protagonist_steps() const { return steps_; }
  virtual void save_more(Saver&) const {}
  virtual void load_more(Loader&) {}

  /// Plays into the rollout and counts its steps; `play` draws the actions of the samples from `first` on, which are
  /// the draws number `step`, and returns an adversary's.
  template <class Play>
  void collect(Play&& play) {
    const auto clock = static_cast<std::uint64_t>(steps_ / options_.environments);
    collector_.collect(rollout_, [&](std::size_t first) { return play(first, clock + first / rollout_.environments); });
    steps_ += options_.samples();
  }
  /// Lets a learner learn from a whole rollout.
  void learn(PpoLearner& learner, Rollout& rollout, double progress);
  /// Ends the training.
  void fail(std::string_view why) { failure_ = cat(why, " after ", steps_, " steps"); }

  /// A network that takes observations as the environments show them.
  ActorNetwork as_seen(const Mlp<float>& mlp) const;
  /// The stream of a purpose of this training.
  Rng stream(std::string_view purpose) const { return rng_.split(purpose); }

  PpoOptions options_;
  TrainingTask task_;

 private:
  std::string identity_;
  std::int64_t total_steps_;
  Rng rng_;

 protected:
  Collector collector_;
  PpoLearner protagonist_;
  Rollout rollout_;

 private:
  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    PpoLearner::archive(archive, self.protagonist_);
    archive.number(self.steps_);
    archive.text(self.failure_);
    LearningCurve::archive(archive, self.curve_);
  }

  LearningCurve curve_;
  std::int64_t steps_ = 0;
  std::string failure_;
};

}  // namespace gust
