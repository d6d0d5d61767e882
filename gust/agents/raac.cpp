#include "gust/agents/off_policy_training.h"
#include "gust/agents/quantile_critic.h"

namespace gust {
namespace {

class Raac final : public Agent {
 public:
  explicit Raac(const RaacOptions& options) : options_(options) {}
  std::int64_t steps() const override { return options_.steps; }
  double work() const override { return options_.work(); }
  std::uint64_t memory(const PlantSpec& spec) const override { return replay_bytes(options_, spec, false); }
  std::unique_ptr<Training> start(const TrainingTask& task) const override {
    OffPolicySetup setup{.options = options_, .identity = cat("raac ", canonical_fields(options_))};
    setup.make_critic = [options = options_](const OffPolicyOptions&, const TransitionShape& shape, Rng rng) {
      return std::make_unique<QuantileCritic>(options, shape, rng);
    };
    return std::make_unique<OffPolicyTraining>(std::move(setup), task);
  }

 private:
  RaacOptions options_;
};

}  // namespace

Entry<Agent> agent_raac() {
  return make_entry<Agent, RaacOptions>(
      "raac",
      "Risk-averse actor-critic: soft actor-critic whose critics know the quantiles of the return, for one risk level.",
      "Urpi, Curi and Krause 2021, on SAC as Glossop et al. 2022 (docs/algorithms.md 5)",
      [](const RaacOptions& options) { return std::make_unique<Raac>(options); });
}

}  // namespace gust
