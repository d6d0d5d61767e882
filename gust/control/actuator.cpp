#include "gust/control/actuator.h"

#include <algorithm>
#include <cmath>

#include "gust/core/math.h"

namespace gust {

Actuator::Actuator(const Interface& spec, const Readings& readings, std::size_t lanes)
    : spec_(spec),
      boxed_(readings.command_clip == "box" || readings.saturate == "before"),
      saturates_(readings.saturate == "after"),
      not_finite_(lanes, 0.0),
      command_(spec.action.size(), lanes),
      commanded_(spec.action.size(), lanes),
      disturbed_(spec.action.size(), lanes),
      applied_(spec.action.size(), lanes) {}

void Actuator::act(Rows<const double> command, std::span<const std::int64_t> step, Disturber& disturber,
                   Rows<const double> offset) noexcept {
  this->command(command);
  for (std::size_t i = 0; i < disturbed_.rows(); ++i) {
    std::ranges::copy(command_.row(i), disturbed_.row(i).begin());
  }
  disturber.apply(Site::kAction, step, disturbed_.view(), offset);
  saturate();
}

/// The policy's unit becomes the physical one; with a box (or where saturation comes first) the command is clipped.
void Actuator::command(Rows<const double> command) noexcept {
  std::ranges::fill(not_finite_, 0.0);
  for (std::size_t i = 0; i < command_.rows(); ++i) {
    const double middle = spec_.action_offset[i], scale = spec_.action_scale[i];
    const double box_low = spec_.normalized_action ? middle - scale : spec_.action_low[i];
    const double box_high = spec_.normalized_action ? middle + scale : spec_.action_high[i];
    for (std::size_t lane = 0; lane < command_.lanes(); ++lane) {
      const double wanted = middle + scale * command.at(i, lane);
      if (!std::isfinite(wanted)) not_finite_[lane] = wanted;
      command_.at(i, lane) = boxed_ ? clip(wanted, box_low, box_high) : wanted;
      commanded_.at(i, lane) = clip(wanted, spec_.action_low[i], spec_.action_high[i]);
    }
  }
}

void Actuator::saturate() noexcept {
  for (std::size_t i = 0; i < applied_.rows(); ++i) {
    for (std::size_t lane = 0; lane < applied_.lanes(); ++lane) {
      const double sum = disturbed_.at(i, lane);
      applied_.at(i, lane) = saturates_ ? clip(sum, spec_.action_low[i], spec_.action_high[i]) : sum;
    }
  }
}

}  // namespace gust
