#include "gust/control/actuator.h"

#include <algorithm>
#include <cmath>

#include "gust/core/math.h"

namespace gust {

Actuator::Actuator(const Interface& spec, const Readings& readings, std::size_t lanes, bool splits)
    : spec_(spec),
      boxed_(readings.command_clip == "box" || readings.saturate == "before"),
      saturates_(readings.saturate == "after"),
      not_finite_(lanes, 0.0),
      command_(spec.action.size(), lanes),
      commanded_(spec.action.size(), lanes),
      disturbed_(spec.action.size(), lanes),
      applied_(spec.action.size(), lanes),
      early_(splits ? spec.action.size() : 0, lanes),
      early_applied_(early_.rows(), lanes) {}

void Actuator::act(Rows<const double> command, std::span<const std::int64_t> step, Disturber& disturber,
                   Rows<const double> offset) noexcept {
  this->command(command);
  for (Matrix<double>* part : {&disturbed_, &early_}) {
    for (std::size_t i = 0; i < part->rows(); ++i) std::ranges::copy(command_.row(i), part->row(i).begin());
  }
  disturber.apply(Site::kAction, step, disturbed_.view(), offset, early_.view());
  saturate(disturbed_, applied_);
  saturate(early_, early_applied_);
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

void Actuator::saturate(const Matrix<double>& wanted, Matrix<double>& applied) const noexcept {
  for (std::size_t i = 0; i < applied.rows(); ++i) {
    for (std::size_t lane = 0; lane < applied.lanes(); ++lane) {
      const double sum = wanted.at(i, lane);
      applied.at(i, lane) = saturates_ ? clip(sum, spec_.action_low[i], spec_.action_high[i]) : sum;
    }
  }
}

}  // namespace gust
