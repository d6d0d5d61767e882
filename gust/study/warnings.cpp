#include "gust/study/warnings.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace gust {
namespace {

bool inside(const Limits& limits, double value) { return limits.low <= value && value <= limits.high; }

std::string bounds_text(const Limits& limits, const std::string& unit) {
  return fmt::format("{:.4g} to {:.4g} {}", limits.low, limits.high, unit);
}

/// "… lie where no policy can hold the plant: its actions reach 0.0243 to 0.0297 kg"
std::string out_of_reach(const Setup& setup, std::size_t parameter, std::string_view what) {
  const Limits possible = possible_values(setup, parameter);
  const std::string reach = possible.low <= possible.high
                                ? bounds_text(possible, setup.plant->spec().parameters[parameter].unit)
                                : "no value at all";
  return cat(what, " where no policy can hold the plant: its actions reach ", reach);
}

void warn_of_axis(const Study& study, const Sweep& sweep, const Sweep::Axis& axis, std::vector<std::string>& warnings) {
  const Limits possible = possible_values(study.setup, axis.index);
  const auto outside = std::ranges::count_if(axis.values, [&](double value) { return !inside(possible, value); });
  if (outside == 0) return;
  const std::string what =
      cat("sweep '", sweep.name, "': ", outside, " of ", axis.values.size(), " values of ", axis.parameter, " lie");
  warnings.push_back(out_of_reach(study.setup, axis.index, what));
}

/// Injections whose window closes before their shape begins.
void warn_of_windows(std::span<const Injection> injections, const std::string& whose,
                     std::vector<std::string>& warnings) {
  for (const Injection& injection : injections) {
    if (injection.end > injection.waveform->onset()) continue;
    warnings.push_back(cat(whose, ": the ", site_name(injection.site), " ", injection.waveform.kind,
                           " disturbs nothing: its window ends at step ", injection.end, ", its shape begins at step ",
                           injection.waveform->onset()));
  }
}

bool starts_failed(const StartProtocol& start, const PlantSpec& spec) {
  for (std::size_t i = 0; i < start.state.size(); ++i) {
    if (start.state[i] < spec.fail_low[i] || start.state[i] > spec.fail_high[i]) return true;
  }
  return false;
}

}  // namespace

Limits possible_values(const Setup& setup, std::size_t parameter) {
  const Parameter& of = setup.plant->spec().parameters[parameter];
  const bool boxed = setup.readings.command_clip == "box" || setup.readings.saturate == "before";
  return boxed ? of.by_box : of.by_actuator;
}

std::vector<std::string> plant_warnings(const Setup& setup) {
  std::vector<std::string> warnings;
  const std::vector<Parameter>& parameters = setup.plant->spec().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (inside(possible_values(setup, i), parameters[i].nominal)) continue;
    const std::string what =
        fmt::format("plant: {} = {:.4g} {} lies", parameters[i].name, parameters[i].nominal, parameters[i].unit);
    warnings.push_back(out_of_reach(setup, i, what));
  }
  return warnings;
}

std::vector<std::string> draw_warnings(const Setup& setup, const Randomisation& randomised) {
  std::vector<std::string> warnings;
  for (const ParameterDraw& draw : randomised.draws) {
    const Limits drawn = {draw.offset + draw.distribution->low(), draw.offset + draw.distribution->high()};
    const Limits possible = possible_values(setup, draw.parameter);
    if (inside(possible, drawn.low) && inside(possible, drawn.high)) continue;
    const Parameter& parameter = setup.plant->spec().parameters[draw.parameter];
    const std::string what =
        cat("randomise: some of ", parameter.name, ", drawn from ", bounds_text(drawn, parameter.unit), ", lie");
    warnings.push_back(out_of_reach(setup, draw.parameter, what));
  }
  return warnings;
}

std::vector<std::string> study_warnings(const Study& study) {
  std::vector<std::string> warnings = plant_warnings(study.setup);
  for (const StartProtocol& start : study.starts) {
    if (starts_failed(start, study.setup.plant->spec()))
      warnings.push_back(cat("start '", start.name, "' lies beyond the bounds at which an episode fails"));
  }
  warn_of_windows(study.always, "evaluate", warnings);
  for (const StudyPolicy& policy : study.policies) {
    for (const auto& [copy, original] : policy.copies)
      warnings.push_back(cat("policy '", policy.name, "': ", copy, " equals ", original,
                             " byte for byte; the two are one policy and count once"));
    warn_of_windows(policy.disturbed, cat("policy '", policy.name, "'"), warnings);
    for (const std::string& warning : draw_warnings(study.setup, policy.randomised))
      warnings.push_back(cat("policy '", policy.name, "': ", warning));
  }
  for (const Sweep& sweep : study.sweeps) {
    for (const Sweep::Axis& axis : sweep.axes) {
      if (!axis.parameter.empty()) warn_of_axis(study, sweep, axis, warnings);
    }
    if (sweep.injection) warn_of_windows({&*sweep.injection, 1}, cat("sweep '", sweep.name, "'"), warnings);
    warn_of_windows(sweep.disturbed, cat("sweep '", sweep.name, "'"), warnings);
    const std::vector<double>& levels = sweep.axes.front().values;
    if (sweep.along_levels() && levels.size() > 1 && levels.front() != 0)
      warnings.push_back(cat("sweep '", sweep.name, "' begins at level ", levels.front(),
                             ": its margins are falls from the score there, not from the undisturbed one"));
  }
  return warnings;
}

}  // namespace gust
