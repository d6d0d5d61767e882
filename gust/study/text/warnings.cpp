#include "gust/study/text/warnings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
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

constexpr double kHalfTurn = std::numbers::pi * (1 + 1e-6);  // a limit that was written as 3.141593 is meant

/// "; are degrees meant? 12 degrees are 0.2094 rad"
std::string degrees_question(double angle) {
  return fmt::format("; are degrees meant? {:.4g} degrees are {:.4g} rad", angle, angle * std::numbers::pi / 180.0);
}

/// A disturbance of observed angles alone that is larger than half a turn.
void warn_of_offset(const Injection& injection, const Interface& spec, const std::string& whose,
                    std::vector<std::string>& warnings) {
  if (injection.site != Site::kObservation) return;
  double most = 0;
  for (std::size_t i = 0; i < injection.factors.size(); ++i) {
    if (injection.factors[i] != 0 && spec.measured()[i].unit != "rad") return;
    most = std::max(most, std::abs(injection.factors[i] * injection.level));
  }
  if (most > kHalfTurn)
    warnings.push_back(fmt::format("{}: the observation {} reaches {:.4g} rad, more than half a turn{}", whose,
                                   injection.kind(), most, degrees_question(most)));
}

/// Injections whose window closes before their shape begins, waves whose shape is coarse, angles in degrees.
void warn_of_injections(std::span<const Injection> injections, const Interface& spec, const std::string& whose,
                        std::vector<std::string>& warnings) {
  std::ranges::move(wave_warnings(injections, spec, whose), std::back_inserter(warnings));
  for (const Injection& injection : injections) {
    warn_of_offset(injection, spec, whose, warnings);
    if (injection.end > injection.onset()) continue;
    warnings.push_back(cat(whose, ": the ", site_name(injection.site), " ", injection.kind(),
                           " disturbs nothing: its window ends at step ", injection.end, ", its shape begins at step ",
                           injection.onset()));
  }
}

/// Angles of the plant's task beyond half a turn: degrees, most likely.
void warn_of_degrees(const PlantSpec& spec, std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < spec.state.size(); ++i) {
    if (spec.state[i].unit != "rad") continue;
    const auto warn = [&](std::string_view what, double angle, std::string_view so) {
      if (!(std::abs(angle) > kHalfTurn) || std::isinf(angle)) return;
      warnings.push_back(fmt::format("plant: {} {} = {:.4g} rad, more than half a turn{}{}", what, spec.state[i].name,
                                     angle, so, degrees_question(angle)));
    };
    warn("an episode fails beyond", spec.fail_high[i], ", so that no attitude fails");
    warn("episodes start at", spec.start[i], "");
    warn("random starts spread by", spec.start_range[i], "");
  }
}

/// Random starts of which some lie outside the safe set.
void warn_of_random_starts(const PlantSpec& spec, std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < spec.state.size(); ++i) {
    const double middle = spec.start[i] + spec.start_offset[i], range = spec.start_range[i];
    if (middle - range >= spec.fail_low[i] && middle + range <= spec.fail_high[i]) continue;
    warnings.push_back(fmt::format(
        "plant: random starts have {} = {:.4g} to {:.4g}, the safe set ends at {:.4g} and {:.4g} {}: some episodes "
        "fail "
        "before their first step",
        spec.state[i].name, middle - range, middle + range, spec.fail_low[i], spec.fail_high[i], spec.state[i].unit));
  }
}

}  // namespace

Limits possible_values(const Setup& setup, std::size_t parameter) {
  const Parameter& of = setup.plant->spec().parameters[parameter];
  const bool boxed = setup.readings.command_clip == "box" || setup.readings.saturate == "before";
  return boxed ? of.by_box : of.by_actuator;
}

std::vector<std::string> wave_warnings(std::span<const Injection> injections, const Interface& spec,
                                       const std::string& whose) {
  constexpr double kFewSamples = 10;  // a period; a sine of as many may miss its peak by 5 %
  std::vector<std::string> warnings;
  for (const Injection& injection : injections) {
    const double frequency = injection.frequency();
    if (kFewSamples * frequency <= spec.control_rate) continue;
    warnings.push_back(fmt::format("{}the {} {} of {:.6g} Hz has {:.3g} samples a period: its shape is coarse",
                                   whose.empty() ? "" : whose + ": ", site_name(injection.site), injection.kind(),
                                   frequency, spec.control_rate / frequency));
  }
  return warnings;
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
  const Plant* plant = setup.plant->plant();
  if (plant == nullptr) return warnings;
  warn_of_degrees(plant->spec(), warnings);
  warn_of_random_starts(plant->spec(), warnings);
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
  const Interface& spec = study.setup.plant->spec();
  std::vector<std::string> warnings = plant_warnings(study.setup);
  warn_of_injections(study.always, spec, "evaluate", warnings);
  for (const StudyPolicy& policy : study.policies) {
    for (const std::string& warning : policy.source->warnings())
      warnings.push_back(cat("policy '", policy.name, "': ", warning));
    const PolicyTraining* training = policy.training();
    if (training == nullptr) continue;
    warn_of_injections(training->disturbed, spec, cat("policy '", policy.name, "'"), warnings);
    for (const std::string& warning : draw_warnings(study.setup, training->randomised))
      warnings.push_back(cat("policy '", policy.name, "': ", warning));
  }
  for (const Sweep& sweep : study.sweeps) {
    for (const Sweep::Axis& axis : sweep.axes) {
      if (!axis.parameter.empty()) warn_of_axis(study, sweep, axis, warnings);
    }
    const std::string whose = cat("sweep '", sweep.name, "'");
    const std::vector<double>& levels = sweep.axes.front().values;
    if (sweep.injection) {
      Injection greatest = *sweep.injection;
      greatest.level = sweep.along_levels() && !levels.empty() ? levels.back() : 0.0;
      warn_of_injections({&greatest, 1}, spec, whose, warnings);
    }
    warn_of_injections(sweep.disturbed, spec, whose, warnings);
    if (sweep.along_levels() && levels.size() > 1 && levels.front() < 0)
      warnings.push_back(cat("sweep '", sweep.name, "' has no margins: its levels begin at ", levels.front(),
                             ", below 0; sweep each side from 0 (the factors of 'channels' turn the sign)"));
  }
  return warnings;
}

}  // namespace gust
