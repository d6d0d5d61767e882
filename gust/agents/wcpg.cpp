#include "gust/agents/gaussian_critic.h"
#include "gust/agents/off_policy_training.h"

namespace gust {
namespace {

/// Gives every transition of a minibatch a level of its own.
void relabel(const RiskLevels& levels, Minibatch& batch, Rng rng) {
  for (std::size_t lane = 0; lane < batch.lanes(); ++lane)
    batch.set_extra(lane, 0, static_cast<float>(levels.low + rng.uniform(lane) * (levels.high - levels.low)));
}

class Wcpg final : public Agent {
 public:
  explicit Wcpg(const WcpgOptions& options) : options_(options) {}
  std::int64_t steps() const override { return options_.steps; }
  double work() const override { return options_.work(); }
  std::uint64_t memory(const PlantSpec& spec) const override { return replay_bytes(options_, spec, true); }
  std::optional<LevelRange> levels() const override { return LevelRange{options_.alpha_min, options_.alpha_max}; }
  std::unique_ptr<Training> start(const TrainingTask& task) const override;

 private:
  WcpgOptions options_;
};

std::unique_ptr<Training> Wcpg::start(const TrainingTask& task) const {
  const RiskLevels levels{options_.alpha_min, options_.alpha_max, options_.acts_at()};
  OffPolicySetup setup{.options = options_, .identity = cat("wcpg ", canonical_fields(options_)), .risk = levels};
  setup.make_critic = [options = options_](const OffPolicyOptions&, const TransitionShape& shape, Rng rng) {
    return std::make_unique<GaussianCritic>(options, shape, rng);
  };
  if (options_.alpha_relabel) setup.prepare = [levels](Minibatch& batch, Rng rng) { relabel(levels, batch, rng); };
  return std::make_unique<OffPolicyTraining>(std::move(setup), task);
}

}  // namespace

Entry<Agent> agent_wcpg() {
  return make_entry<Agent, WcpgOptions>(
      "wcpg",
      "Worst cases policy gradients: soft actor-critic whose critics know mean and variance of the return, for one "
      "risk "
      "level or all.",
      "Tang, Zhang and Salakhutdinov 2020, on SAC as Glossop et al. 2022 (docs/algorithms.md 4)",
      [](const WcpgOptions& options) { return std::make_unique<Wcpg>(options); });
}

}  // namespace gust
