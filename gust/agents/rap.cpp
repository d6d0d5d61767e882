#include "gust/agents/rap.h"

#include <algorithm>

namespace gust {
namespace {

class Rap final : public Agent {
 public:
  explicit Rap(const RapOptions& options) : options_(options) {}
  std::int64_t steps() const override { return options_.steps; }
  double work() const override { return options_.work(); }
  bool disturbs() const override { return true; }
  void check(const PlantSpec& spec, const Place& place) const override { options_.check_plant(spec, place); }
  std::unique_ptr<Training> start(const TrainingTask& task) const override {
    return std::make_unique<RapTraining>(options_, task);
  }

 private:
  RapOptions options_;
};

/// A rollout of the shape that the adversaries' has.
Rollout shape_of(const Rollout& rollout, const Environments& environments) {
  return Rollout(rollout.environments, rollout.steps, rollout.observations, environments.channels());
}

}  // namespace

RapTraining::RapTraining(const RapOptions& options, const TrainingTask& task)
    : PpoTraining(options, task, {.identity = cat("rap 1 ", canonical_fields(options)), .against = options.against()}),
      game_(options),
      population_(options, options.shared(), shape_of(rollout_, collector_.environments()), stream("population")) {}

/// One rollout in which each environment has its adversary; then the protagonist learns from all of it, and every
/// adversary from what was its own.
void RapTraining::iterate(double progress) {
  if (game_.reset_each_rollout) {
    collector_.restart();
    population_.draw(std::vector<std::uint8_t>(rollout_.environments, 1));
  }
  collect([&](std::size_t first, std::uint64_t step) {
    if (first > 0) hold_for_episode();
    protagonist_.sample(rollout_, first, step);
    return population_.act(rollout_, first, step);
  });
  hold_for_episode();
  learn(protagonist_, rollout_, progress);
  if (failure().empty() && !population_.learn(rollout_, progress)) fail("an adversary's numbers are not finite");
}

/// Where an episode has just ended, the next one draws its adversary; but not where rollouts draw.
void RapTraining::hold_for_episode() {
  if (!game_.reset_each_rollout) population_.draw(collector_.environments().done());
}

std::vector<TrainedAdversary> RapTraining::adversaries() const {
  std::vector<TrainedAdversary> trained;
  for (std::size_t k = 0; k < population_.learners().size(); ++k) {
    AdversarySite against = game_.against();
    against.scale *= population_.strength(k);
    trained.push_back({as_seen(population_.learners()[k].actor()), against});
  }
  return trained;
}

/// Owners are positions in the population.
void RapTraining::load_more(Loader& loader) {
  Population::archive(loader, population_);
  const std::size_t size = population_.learners().size();
  if (std::ranges::any_of(population_.owners(), [&](std::size_t owner) { return owner >= size; })) Loader::fail();
}

Entry<Agent> agent_rap() {
  return make_entry<Agent, RapOptions>(
      "rap", "PPO against a population of adversaries: every environment has one, and all sides learn at once.",
      "Vinitsky et al. 2020; safe-control-gym's RAP (docs/algorithms.md 3.3)",
      [](const RapOptions& options) { return std::make_unique<Rap>(options); });
}

}  // namespace gust
