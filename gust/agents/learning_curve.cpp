#include "gust/agents/learning_curve.h"

#include <cmath>

#include "gust/agents/lanes.h"
#include "gust/control/episode.h"

namespace gust {
namespace {

constexpr std::size_t kEpisodes = 10;

}  // namespace

CurvePoint measure_actor(const TrainingTask& task, const ActorNetwork& actor, Rng rng) {
  const PlantSpec& spec = task.plant->spec();
  ActorRunner runner(actor, kEpisodes);
  Buffer<float> observation(kEpisodes * spec.observations());
  const std::span<const Injection> injections = task.curve_as_trained ? task.injections : std::span<const Injection>();
  const auto randomised = task.curve_as_trained ? task.randomised : std::span<const ParameterDraw>();
  std::vector<double> levels;
  for (const Injection& injection : injections) levels.push_back(injection.level);
  ClosedLoop loop(*task.plant, task.readings, injections, kEpisodes);
  EpisodeMeter meter(spec, kEpisodes);
  Matrix<double> action(spec.action.size(), kEpisodes);
  for (std::size_t lane = 0; lane < kEpisodes; ++lane) {
    const Rng episode = rng.split(lane);
    loop.begin(lane, {.state = random_start(spec, episode),
                      .parameters = draw_parameters(randomised, spec, episode),
                      .levels = levels,
                      .signals = SignalSequence(injections, spec, levels, episode).at(0)});
  }
  for (std::int64_t k = 0; k < spec.steps; ++k) {
    to_lanes(loop.observation(), observation);
    to_rows(runner.act(observation), action.view());
    loop.step(action.view());
    meter.record(loop);
  }

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
