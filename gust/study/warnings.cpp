#include "gust/study/warnings.h"

#include <algorithm>
#include <cmath>

namespace gust {
namespace {

std::string bounds_text(const Limits& limits, const std::string& unit) {
  return fmt::format("{:.4g} to {:.4g} {}", limits.low, limits.high, unit);
}

void warn_of_axis(const Study& study, const Sweep& sweep, const Sweep::Axis& axis, std::vector<std::string>& warnings) {
  const Limits possible = possible_values(study.setup, axis.index);
  const auto outside =
      std::ranges::count_if(axis.values, [&](double value) { return value < possible.low || value > possible.high; });
  if (outside == 0) return;
  const Parameter& parameter = study.setup.plant->spec().parameters[axis.index];
  warnings.push_back(cat("sweep '", sweep.name, "': ", outside, " of ", axis.values.size(), " values of ",
                         parameter.name, " lie where no policy can hold the plant: its actions reach ",
                         bounds_text(possible, parameter.unit)));
}

}  // namespace

Limits possible_values(const Setup& setup, std::size_t parameter) {
  const Parameter& of = setup.plant->spec().parameters[parameter];
  const bool boxed = setup.readings.command_clip == "box" || setup.readings.saturate == "before";
  return boxed ? of.by_box : of.by_actuator;
}

std::vector<std::string> study_warnings(const Study& study) {
  std::vector<std::string> warnings;
  for (const Sweep& sweep : study.sweeps) {
    for (const Sweep::Axis& axis : sweep.axes) {
      if (!axis.parameter.empty()) warn_of_axis(study, sweep, axis, warnings);
    }
  }
  return warnings;
}

}  // namespace gust
