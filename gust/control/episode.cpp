#include "gust/control/episode.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

double of_lane(std::span<const double> numbers, std::size_t lane) {
  return numbers.empty() ? std::numeric_limits<double>::quiet_NaN() : numbers[lane];
}

bool flag(std::span<const std::uint8_t> flags, std::size_t lane) { return !flags.empty() && flags[lane] != 0; }

StepTally tally(const StepRecord& of, const Interface& spec, std::size_t lane) {
  StepTally step{
      of.reward[lane], of_lane(of.reward_commanded, lane), of_lane(of.reward_disturbed, lane), 0, 0, 0, false};
  for (std::size_t i = 0; i < of.state.rows; ++i) step.state += of.state.at(i, lane) * of.state.at(i, lane);
  for (std::size_t i = 0; i < of.goal.rows; ++i) {
    const double error = of.state.at(i, lane) - of.goal.at(i, lane);
    step.squared += error * error;
    step.masked += spec.error_weights[i] * error * error;
  }
  for (std::size_t i = 0; i < of.disturbed.rows; ++i) {
    const double wanted = of.disturbed.at(i, lane);
    step.saturated = step.saturated || wanted < spec.action_low[i] || wanted > spec.action_high[i];
  }
  return step;
}

}  // namespace

std::string not_finite_text(const NotFiniteAction& action, const Interface& spec) {
  const char* gave = std::isnan(action.value) ? "NaN" : "an infinite action";
  std::string text = cat("the policy gave ", gave, " at step ", action.step);
  if (spec.state.empty()) return text;
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < action.state.size(); ++i)
    parts.push_back(format("{} = {:.4g} {}", spec.state[i].name, action.state[i], spec.state[i].unit));
  return cat(text, ", state ", join(parts, ", "));
}

EpisodeMeter::EpisodeMeter(const Interface& spec, std::size_t lanes) : spec_(spec), episodes_(lanes) {
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

void EpisodeMeter::record(const StepRecord& step) {
  const std::size_t lanes = episodes_.size();
  GUST_CHECK(step.reward.size() == lanes && step.state.rows == spec_.state.size() &&
             step.goal.rows == spec_.error_weights.size() && (!spec_.fails || step.failed.size() == lanes) &&
             (!spec_.tells_effort || step.disturbed.rows == spec_.action.size()));
  for (std::size_t lane = 0; lane < episodes_.size(); ++lane) record_lane(step, lane);
}

void EpisodeMeter::record_lane(const StepRecord& of, std::size_t lane) {
  Episode& episode = episodes_[lane];
  const bool stopped = episode.failed && !spec_.goes_on;
  if (episode.whole.steps >= episode.horizon || episode.over || stopped) return;
  const StepTally step = tally(of, spec_, lane);
  const double given = of.not_finite_command.empty() ? 0.0 : of.not_finite_command[lane];
  if (given != 0.0 && !episode.failed && !episode.not_finite) {
    episode.not_finite = {episode.whole.steps, given, {}};
    if (episode.whole.steps > 0) episode.not_finite->state = episode.whole.final_state;
  }
  if (!episode.failed) {
    add(episode.ended, step, of.state, lane);
    ++episode.safe_steps;
  }
  add(episode.whole, step, of.state, lane);
  episode.failed = episode.failed || flag(of.failed, lane);
  episode.over = flag(of.over, lane);
  episode.touched_ground = flag(of.touched_ground, lane);
  const double reward = of.reward_disturbed.empty() ? step.reward : step.disturbed;
  episode.finite = episode.finite && std::isfinite(step.squared) && std::isfinite(reward);
}

}  // namespace gust
