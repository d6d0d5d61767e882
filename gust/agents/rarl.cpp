#include "gust/agents/rarl.h"

#include <algorithm>

namespace gust {
namespace {

class Rarl final : public Agent {
 public:
  explicit Rarl(const RarlOptions& options) : options_(options) {}
  std::int64_t steps() const override { return options_.steps; }
  double work() const override { return options_.work(); }
  bool disturbs() const override { return true; }
  void check(const PlantSpec& spec, const Place& place) const override { options_.check_plant(spec, place); }
  std::unique_ptr<Training> start(const TrainingTask& task) const override {
    return std::make_unique<RarlTraining>(options_, task);
  }

 private:
  RarlOptions options_;
};

}  // namespace

RarlTraining::RarlTraining(const RarlOptions& options, const TrainingTask& task)
    : PpoTraining(options, task,
                  {.identity = cat("rarl 1 ", canonical_fields(options)),
                   .against = options.against(),
                   .rollouts = options.agent_iterations + options.adversary_iterations}),
      game_(options),
      adversary_(options, rollout_.observations, collector_.environments().channels(), stream("adversary")),
      against_(rollout_.environments, rollout_.steps, rollout_.observations, collector_.environments().channels()) {}

/// One rollout in which both sides act, each on what the protagonist sees; then the side whose turn it is learns.
void RarlTraining::iterate(double progress) {
  const bool ours = protagonists_turn();
  collect([&](std::size_t first, std::uint64_t step) {
    protagonist_.sample(rollout_, first, step);
    std::ranges::copy(rollout_.observation_at(first), against_.observation_at(first).begin());
    adversary_.sample(against_, first, step);
    return std::span<const float>(against_.action_at(first));
  });
  oppose(rollout_, against_);
  if (ours) {
    protagonist_steps_ += options_.samples();
    learn(protagonist_, rollout_, progress);
  } else {
    learn(adversary_, against_, progress);
  }
}

bool RarlTraining::protagonists_turn() const {
  const std::int64_t rollouts = steps() / options_.samples();
  return rollouts % (game_.agent_iterations + game_.adversary_iterations) < game_.agent_iterations;
}

std::vector<TrainedAdversary> RarlTraining::adversaries() const {
  return {{as_seen(adversary_.actor()), game_.against()}};
}

Entry<Agent> agent_rarl() {
  return make_entry<Agent, RarlOptions>(
      "rarl", "PPO against an adversary that learns to disturb it: both sides act, and learn in turn.",
      "Pinto et al. 2017; safe-control-gym's RARL (docs/algorithms.md 3.2)",
      [](const RarlOptions& options) { return std::make_unique<Rarl>(options); });
}

}  // namespace gust
