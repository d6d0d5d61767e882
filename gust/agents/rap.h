#pragma once

#include "gust/agents/adversarial.h"
#include "gust/agents/population.h"
#include "gust/agents/ppo_training.h"

namespace gust {

/// Robustness by adversary populations (Vinitsky et al. 2020), as safe-control-gym has it (docs/algorithms.md 3.3).
struct RapOptions : AdversarialOptions {
  RapOptions() { site = "action"; }

  std::int64_t population = 2;
  bool reset_each_rollout = false;
  bool joint_advantages = false;
  std::int64_t strength_bins = 1;

  static constexpr std::tuple kFields = std::tuple_cat(
      AdversarialOptions::kFields,
      std::tuple{
          field("population", &RapOptions::population, "adversaries, of which each environment draws one",
                between(1, 8)),
          field("reset_each_rollout", &RapOptions::reset_each_rollout,
                "every rollout begins new episodes and draws adversaries; else episodes go on, each with its own"),
          field("joint_advantages", &RapOptions::joint_advantages,
                "advantages are standardised over the samples of all adversaries together, not of each by itself"),
          field("strength_bins", &RapOptions::strength_bins,
                "adversary k = 0, 1, 2 ... reaches (k mod bins + 1) / bins of the scale", between(1, 8)),
      });

  Population::Options shared() const { return {population, strength_bins, joint_advantages}; }
};

/// A protagonist that learns from rollouts in which every environment has one adversary of a population; all sides
/// learn from each rollout, the adversaries each from its own samples. Each side learns by PPO; the adversaries'
/// rewards are the protagonist's, negated.
class RapTraining final : public PpoTraining {
 public:
  RapTraining(const RapOptions& options, const TrainingTask& task);

  const Population& population() const { return population_; }
  std::vector<TrainedAdversary> adversaries() const override;

 private:
  void iterate(double progress) override;
  void hold_for_episode();
  void save_more(Saver& saver) const override { Population::archive(saver, population_); }
  void load_more(Loader& loader) override;

  RapOptions game_;
  Population population_;
};

}  // namespace gust
