#include "gust/agents/learning_curve.h"

#include <cmath>

#include "gust/agents/lanes.h"
#include "gust/control/closed_loop.h"
#include "gust/control/episode.h"

namespace gust {
namespace {

constexpr std::size_t kEpisodes = 10;

/// An actor as it is in training: its networks compute in float.
class ActorPolicy final : public Policy {
 public:
  ActorPolicy(const ActorNetwork& actor, const Interface& spec)
      : runner_(actor, kEpisodes), observation_(kEpisodes * spec.observations()), actions_(spec.action.size()) {}

  std::size_t observations() const override { return observation_.size() / kEpisodes; }
  std::size_t actions() const override { return actions_; }
  void act(Rows<const double> observation, std::span<const std::int64_t>, Rows<double> action) override {
    to_lanes(observation, observation_);
    to_rows(runner_.act(observation_), action);
  }

 private:
  ActorRunner runner_;
  Buffer<float> observation_;
  std::size_t actions_;
};

}  // namespace

CurvePoint measure_actor(const TrainingTask& task, const ActorNetwork& actor, Rng rng) {
  const PlantSpec& spec = task.plant->spec();
  const std::span<const Injection> injections = task.curve_as_trained ? task.injections : std::span<const Injection>();
  const auto randomised = task.curve_as_trained ? task.randomised : std::span<const ParameterDraw>();
  std::vector<double> levels;
  for (const Injection& injection : injections) levels.push_back(injection.level);
  std::vector<EpisodeStart> starts;
  for (std::size_t lane = 0; lane < kEpisodes; ++lane) {
    const Rng episode = rng.split(lane);
    starts.push_back({.state = random_start(spec, episode),
                      .parameters = draw_parameters(randomised, spec, episode),
                      .levels = levels,
                      .signals = SignalSequence(injections, spec, levels, episode).at(0)});
  }
  ClosedLoop loop(*task.plant, task.readings, injections, kEpisodes);
  ActorPolicy policy(actor, spec);
  EpisodeMeter meter(spec, kEpisodes);
  run_episodes(loop, policy, starts, [&](std::int64_t steps) {
    if (steps > 0) meter.record(loop.record());
  });

  CurvePoint point;
  double squares = 0.0;
  for (std::size_t lane = 0; lane < kEpisodes; ++lane) {
    const EpisodePart& part = meter.episode(lane).ended;
    const auto length = static_cast<double>(part.steps);
    point.return_mean += part.return_sum / kEpisodes;
    squares += part.return_sum * part.return_sum / kEpisodes;
    point.length_mean += length / kEpisodes;
    point.anr += part.return_sum / length / kEpisodes;
    point.anr_h += part.return_sum / static_cast<double>(spec.steps) / kEpisodes;
    point.rmse_scg += std::sqrt(part.squared_masked_error / length) / kEpisodes;
  }
  point.return_std = std::sqrt(std::max(squares - point.return_mean * point.return_mean, 0.0));
  return point;
}

void LearningCurve::follow(const Training& training, std::int64_t steps, bool last,
                           std::optional<std::int64_t> protagonist_steps) {
  const std::int64_t passed = points_.empty() ? -1 : points_.back().steps / kStepsBetweenPoints;
  if (steps / kStepsBetweenPoints == passed && !last) return;
  points_.push_back(measure_actor(task_, training.actor(), rng_.split(points_.size())));
  points_.back().steps = steps;
  points_.back().protagonist_steps = protagonist_steps.value_or(steps);
}

}  // namespace gust
