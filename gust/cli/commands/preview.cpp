#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "gust/cli/command.h"
#include "gust/cli/terminal_chart.h"
#include "gust/control/disturber.h"
#include "gust/core/text.h"
#include "gust/study/text/warnings.h"
#include "gust/study/trials/folder.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

/// The channels that are drawn once: alone if the waveform is random, else with all that look the same.
std::vector<std::vector<std::size_t>> channel_groups(const Injection& injection) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t c = 0; c < injection.factors.size(); ++c) {
    if (injection.factors[c] == 0) continue;
    const auto alike = std::ranges::find_if(groups, [&](const std::vector<std::size_t>& group) {
      return !injection.random() && injection.factors[group.front()] == injection.factors[c];
    });
    if (alike == groups.end()) {
      groups.push_back({c});
    } else {
      alike->push_back(c);
    }
  }
  return groups;
}

/// One injection at a level over the steps of an episode.
struct Drawn {
  const Injection& injection;
  std::size_t index;  ///< among the signals
  double level;
};

constexpr std::size_t kUsualWidth = 80;
constexpr std::size_t kLabels = 11;  // columns left of a chart

std::size_t width() { return std::min(kUsualWidth, terminal_columns(STDOUT_FILENO, kUsualWidth)); }

std::size_t chart_columns() { return std::max(width(), 2 * kLabels) - kLabels; }

/// Lines that are indented by so many spaces, and their continuations by two more.
std::string indented(const std::string& text, std::size_t indent) {
  return cat(std::string(indent, ' '), wrapped(text, width() - indent - 2, indent + 2), "\n");
}

/// What is left of a wave at the control steps of its window: how often it is sampled, and how far it swings.
std::string sampled_text(const Drawn& drawn, std::span<const double> values, double factor, const Interface& spec) {
  const double frequency = drawn.injection.frequency();
  if (frequency == 0) return {};
  const std::int64_t end = std::min(drawn.injection.end, spec.steps);
  const auto [low, high] = std::ranges::minmax(values.subspan(static_cast<std::size_t>(drawn.injection.start),
                                                              static_cast<std::size_t>(end - drawn.injection.start)));
  const double scale = drawn.level * factor;
  return fmt::format("{:.4g} samples a period: {:.4g} to {:.4g} of the level reach the {}",
                     spec.control_rate / frequency, std::min(low / scale, high / scale),
                     std::max(low / scale, high / scale),
                     drawn.injection.site == Site::kObservation ? "policy" : "plant");
}

std::string time_axis(const Interface& spec) {
  return fmt::format("{:>{}}{:<8.4g}{:>{}.4g} s\n", "", kLabels, 0.0,
                     static_cast<double>(spec.steps) / spec.control_rate, chart_columns() - 10);
}

/// What an effect makes of a step from 0 to 1, a tenth of the episode after its window begins.
std::string effect_drawing(const Drawn& drawn, const Interface& spec) {
  const Injection& injection = drawn.injection;
  const std::size_t channels = injection.factors.size();
  const auto channel = static_cast<std::size_t>(std::ranges::find(injection.factors, 1.0) - injection.factors.begin());
  const std::int64_t edge = injection.start + spec.steps / 10;
  Disturber disturber(std::span(&injection, 1), {spec.steps, spec.control_rate}, 1);
  disturber.begin(0, {.levels = {drawn.level},
                      .signals = SignalSequence(std::span(&injection, 1), spec, {drawn.level}, Rng(0)).at(0)});
  std::vector<double> values;
  for (std::int64_t k = 0; k < spec.steps; ++k) {
    Matrix<double> signal(channels, 1, k < edge ? 0.0 : 1.0);
    disturber.apply(injection.site, std::span(&k, 1), signal.view(), {});
    values.push_back(signal.at(channel, 0));
  }
  return indented(cat("what becomes of a step at ", static_cast<double>(edge) / spec.control_rate, " s"), 2) +
         terminal_chart(values, {.columns = chart_columns(), .unicode = locale_is_utf8()});
}

std::string drawing(const Drawn& drawn, const Signals& signals, const Interface& spec) {
  if (drawn.injection.is_effect()) return effect_drawing(drawn, spec) + time_axis(spec);
  const std::vector<Component>& channels = channels_of(drawn.injection.site, spec);
  std::string text;
  for (const std::vector<std::size_t>& group : channel_groups(drawn.injection)) {
    std::vector<std::string> names;
    for (const std::size_t channel : group)
      names.push_back(cat(channels[channel].name, " [", channels[channel].unit, "]"));
    const double factor = drawn.injection.factor(drawn.level);
    std::vector<double> values(static_cast<std::size_t>(spec.steps));
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k] = factor * signals.channel(drawn.index, group.front())[k];
    }
    text += indented(join(names, ", "), 2);
    const std::string sampled = sampled_text(drawn, values, drawn.injection.factors[group.front()], spec);
    if (!sampled.empty()) text += indented(sampled, 2);
    text += terminal_chart(values, {.columns = chart_columns(), .unicode = locale_is_utf8()});
  }
  return text + time_axis(spec);
}

std::string numbers_text(const std::vector<double>& values) {
  if (values.empty()) return "found by the run";
  if (values.size() == 1) return cat(values.front());
  return cat(values.front(), " to ", values.back(), " in ", values.size(), " values");
}

std::string axes_text(const Sweep& sweep) {
  std::vector<std::string> parts;
  for (const Sweep::Axis& axis : sweep.axes) {
    parts.push_back(cat(axis.name(), " ", numbers_text(axis.values)));
  }
  return join(parts, ", ");
}

/// The greatest level of a sweep, or one where that draws nothing.
double shown_level(const Sweep& sweep) {
  double shown = 0;
  const auto levels = std::ranges::find(sweep.axes, "level", &Sweep::Axis::name);
  for (const double level : levels->values) shown = std::abs(level) > std::abs(shown) ? level : shown;
  return shown == 0 ? 1.0 : shown;
}

/// The first cell of a sweep; of levels that a run finds there is none yet, any will do.
std::unique_ptr<TrialEvaluation> first_cell(Study study, std::size_t index) {
  Sweep::Axis& axis = study.sweeps[index].axes.front();
  if (axis.values.empty()) axis.values = {1.0};
  Trial trial;
  trial.sweep = index;
  return trial_evaluation(study, trial);
}

std::string preview_sweep(const Study& study, std::size_t index) {
  const Sweep& sweep = study.sweeps[index];
  std::string text = cat("\n", indented(cat(sweep.name, ": ", axes_text(sweep)), 0));
  const std::string setting = sweep.setting(study.setup.plant->spec());
  if (!setting.empty()) text += indented(cat("with ", setting), 2);
  if (!sweep.injection) return text;
  const std::unique_ptr<TrialEvaluation> task = first_cell(study, index);
  const Drawn drawn{*sweep.injection, task->injections.size() - 1, shown_level(sweep)};
  text += indented(cat(sweep.injection->canonical(), "; drawn at level ", drawn.level), 2);
  task->evaluation.cells.front().levels.back() = drawn.level;
  return text + drawing(drawn, *episode_signals(task->evaluation, {}), study.setup.plant->spec());
}

/// What is on in every evaluation.
std::string preview_always(const Study& study) {
  const std::unique_ptr<TrialEvaluation> task = trial_evaluation(study, Trial{});
  std::string text;
  for (std::size_t i = 0; i < study.always.size(); ++i) {
    const Drawn drawn{study.always[i], i, study.always[i].level};
    text += cat("\nin every evaluation\n", indented(cat(drawn.injection.canonical(), "; level ", drawn.level), 2));
    text += drawing(drawn, *episode_signals(task->evaluation, {}), study.setup.plant->spec());
  }
  return text;
}

/// What is on while a policy is trained: said, not drawn, for every training episode meets another realisation.
std::string preview_training(const Study& study) {
  std::string text;
  for (const StudyPolicy& policy : study.policies) {
    const PolicyTraining* training = policy.training();
    for (const Injection& injection : training ? training->disturbed : std::vector<Injection>()) {
      text += cat("\n", indented(cat("while ", policy.name, " trains"), 0),
                  indented(cat(injection.canonical(), "; level ", injection.level), 2));
    }
  }
  return text;
}

}  // namespace

void command_preview(CLI::App& app, int&) {
  struct Options {
    std::string study;
    std::vector<std::string> settings;
  };
  auto options = std::make_shared<Options>();  // shared: the callback outlives this function
  CLI::App* command = app.add_subcommand("preview",
                                         "Draws the disturbances of a study in the terminal and runs nothing\n\n"
                                         "Random ones are drawn as the first evaluation episode meets them; a sweep at "
                                         "its greatest level.");
  command->add_option("STUDY", options->study, "the study, a TOML file")->required();
  command->add_option("--set", options->settings, "replace a value of the study")->type_name("KEY=VALUE");
  command->footer("Example:\n  gust preview studies/demo.toml");
  command->callback([options] {
    const Study study = StudyFolder::read(options->study, options->settings);
    const Interface& spec = study.setup.plant->spec();
    for (const std::string& warning : study_warnings(study)) tell(cat("warning: ", warning));
    std::string text =
        indented(cat(study.name, ": ", study.setup.plant.kind, study.setup.preset.empty() ? "" : ", ",
                     study.setup.preset, ", ", spec.steps, " control steps at ", spec.control_rate, " Hz"),
                 0);
    text += preview_always(study) + preview_training(study);
    for (std::size_t i = 0; i < study.sweeps.size(); ++i) text += preview_sweep(study, i);
    print_lines(text);
  });
}

}  // namespace gust
