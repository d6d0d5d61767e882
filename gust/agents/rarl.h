#pragma once

#include "gust/agents/adversarial.h"
#include "gust/agents/ppo_training.h"

namespace gust {

/// Robust adversarial reinforcement learning (Pinto et al. 2017), as safe-control-gym has it (docs/algorithms.md 3.2).
struct RarlOptions : AdversarialOptions {
  std::int64_t agent_iterations = 1;
  std::int64_t adversary_iterations = 1;

  static constexpr std::tuple kFields = std::tuple_cat(
      AdversarialOptions::kFields,
      std::tuple{
          field("agent_iterations", &RarlOptions::agent_iterations, "rollouts in turn that the protagonist learns from",
                between(1, 1'000'000)),
          field("adversary_iterations", &RarlOptions::adversary_iterations,
                "rollouts in turn that the adversary learns from; they count as steps, too", between(1, 1'000'000)),
      });
};

/// A protagonist and an adversary that learn in turn from rollouts in which both act. Each side learns by PPO; the
/// adversary's rewards are the protagonist's, negated.
class RarlTraining final : public PpoTraining {
 public:
  RarlTraining(const RarlOptions& options, const TrainingTask& task);

  const PpoLearner& adversary() const { return adversary_; }
  /// The last rollout as the adversary has it.
  const Rollout& adversary_rollout() const { return against_; }
  std::vector<TrainedAdversary> adversaries() const override;

 private:
  void iterate(double progress) override;
  bool protagonists_turn() const;
  std::int64_t protagonist_steps() const override { return protagonist_steps_; }
  void save_more(Saver& saver) const override { archive(saver, *this); }
  void load_more(Loader& loader) override { archive(loader, *this); }

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    PpoLearner::archive(archive, self.adversary_);
    archive.number(self.protagonist_steps_);
  }

  RarlOptions game_;
  PpoLearner adversary_;
  Rollout against_;
  std::int64_t protagonist_steps_ = 0;
};

}  // namespace gust
