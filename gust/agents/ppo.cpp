#include "gust/agents/ppo_training.h"

namespace gust {
namespace {

/// One rollout of the protagonist by itself, then as many minibatch steps as its epochs have.
class LoneTraining final : public PpoTraining {
 public:
  LoneTraining(const PpoOptions& options, const TrainingTask& task)
      : PpoTraining(options, task, {.identity = cat("ppo 2 ", canonical_fields(options))}) {}

 private:
  void iterate(double progress) override {
    collect([&](std::size_t first, std::uint64_t step) {
      protagonist_.sample(rollout_, first, step);
      return std::span<const float>{};
    });
    learn(protagonist_, rollout_, progress);
  }
};

class Ppo final : public Agent {
 public:
  explicit Ppo(const PpoOptions& options) : options_(options) {}
  std::int64_t steps() const override { return options_.steps; }
  double work() const override { return options_.work(); }
  std::unique_ptr<Training> start(const TrainingTask& task) const override {
    return std::make_unique<LoneTraining>(options_, task);
  }

 private:
  PpoOptions options_;
};

}  // namespace

Entry<Agent> agent_ppo() {
  return make_entry<Agent, PpoOptions>(
      "ppo", "Proximal policy optimisation: a stochastic actor and a critic that learn from clipped steps.",
      "Schulman et al. 2017; safe-control-gym's PPO (docs/algorithms.md 1)",
      [](const PpoOptions& options) { return std::make_unique<Ppo>(options); });
}

}  // namespace gust
