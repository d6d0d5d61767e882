#include "gust/control/episode.h"

#include <algorithm>
#include <cmath>

#include "gust/core/text.h"

namespace gust {
namespace {

/// What one step adds to a part.
struct StepTally {
  double reward, commanded, disturbed, squared, masked, state;
  bool saturated;
};

void add(EpisodePart& part, const StepTally& step, Rows<const double> state, std::size_t lane) {
  ++part.steps;
  part.return_sum += step.reward;
  part.return_commanded += step.commanded;
  part.return_disturbed += step.disturbed;
  part.squared_error += step.squared;
  part.squared_masked_error += step.masked;
  part.squared_state += step.state;
  part.saturated_steps += step.saturated ? 1 : 0;
  for (std::size_t i = 0; i < state.rows; ++i) {
    part.max_abs_state[i] = std::max(part.max_abs_state[i], std::abs(state.at(i, lane)));
    part.final_state[i] = state.at(i, lane);
  }
}

StepTally tally(const ClosedLoop& loop, const PlantSpec& spec, std::size_t lane) {
  StepTally step{loop.reward()[lane], loop.reward_commanded()[lane], loop.reward_disturbed()[lane], 0, 0, 0, false};
  for (std::size_t i = 0; i < spec.state.size(); ++i) {
    const double value = loop.state().at(i, lane);
    const double error = value - loop.goal().at(i, lane);
    step.state += value * value;
    step.squared += error * error;
    step.masked += spec.error_weights[i] * error * error;
  }
  for (std::size_t i = 0; i < spec.action.size(); ++i) {
    const double wanted = loop.disturbed().at(i, lane);
    step.saturated = step.saturated || wanted < spec.action_low[i] || wanted > spec.action_high[i];
  }
  return step;
}

}  // namespace

std::string not_finite_text(const NotFiniteAction& action, const PlantSpec& spec) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < action.state.size(); ++i)
    parts.push_back(format("{} = {:.4g} {}", spec.state[i].name, action.state[i], spec.state[i].unit));
  const char* gave = std::isnan(action.value) ? "NaN" : "an infinite action";
  return cat("the policy gave ", gave, " at step ", action.step, ", state ", join(parts, ", "));
}

EpisodeMeter::EpisodeMeter(const PlantSpec& spec, std::size_t lanes) : spec_(spec), episodes_(lanes) {
  for (std::size_t lane = 0; lane < lanes; ++lane) begin(lane);
}

void EpisodeMeter::begin(std::size_t lane) {
  Episode& episode = episodes_[lane];
  episode = Episode{};
  episode.control_rate = spec_.control_rate;
  episode.horizon = spec_.steps;
  episode.angle = spec_.angle;
  for (EpisodePart* part : {&episode.ended, &episode.whole}) {
    part->max_abs_state.assign(spec_.state.size(), 0.0);
    part->final_state.assign(spec_.state.size(), 0.0);
  }
}

void EpisodeMeter::record(const ClosedLoop& loop) {
  for (std::size_t lane = 0; lane < episodes_.size(); ++lane) record_lane(loop, lane);
}

void EpisodeMeter::record_lane(const ClosedLoop& loop, std::size_t lane) {
  Episode& episode = episodes_[lane];
  if (episode.whole.steps >= episode.horizon) return;
  const StepTally step = tally(loop, spec_, lane);
  const double given = loop.not_finite_command(lane);
  if (given != 0.0 && !episode.failed && !episode.not_finite) {
    episode.not_finite = {episode.whole.steps, given, {}};
    if (episode.whole.steps > 0) episode.not_finite->state = episode.whole.final_state;
  }
  if (!episode.failed) {
    add(episode.ended, step, loop.state(), lane);
    ++episode.safe_steps;
  }
  add(episode.whole, step, loop.state(), lane);
  episode.failed = episode.failed || loop.failed(lane);
  episode.touched_ground = loop.touched_ground(lane);
  episode.finite = episode.finite && std::isfinite(step.squared) && std::isfinite(step.disturbed);
}

}  // namespace gust
