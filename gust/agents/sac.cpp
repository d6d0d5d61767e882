#include "gust/agents/off_policy_training.h"
#include "gust/agents/twin_critic.h"

namespace gust {
namespace {

class Sac final : public Agent {
 public:
  explicit Sac(const OffPolicyOptions& options) : options_(options) {}
  std::int64_t steps() const override { return options_.steps; }
  double work() const override { return options_.work(); }
  std::uint64_t memory(const PlantSpec& spec) const override { return replay_bytes(options_, spec, false); }
  std::unique_ptr<Training> start(const TrainingTask& task) const override {
    const auto twins = [](const OffPolicyOptions& options, const TransitionShape& shape, Rng rng) {
      return std::make_unique<TwinCritic>(options, shape, rng);
    };
    return std::make_unique<OffPolicyTraining>(
        OffPolicySetup{.options = options_, .identity = cat("sac ", canonical_fields(options_)), .make_critic = twins},
        task);
  }

 private:
  OffPolicyOptions options_;
};

}  // namespace

Entry<Agent> agent_sac() {
  return make_entry<Agent, OffPolicyOptions>(
      "sac", "Soft actor-critic: a squashed Gaussian actor and twin critics that learn from a replay buffer.",
      "Haarnoja et al. 2018; safe-control-gym's SAC (docs/algorithms.md 2)",
      [](const OffPolicyOptions& options) { return std::make_unique<Sac>(options); });
}

}  // namespace gust
