#include "gust/report/study_episodes.h"

#include <algorithm>
#include <cmath>

#include "gust/study/trials/trials.h"

namespace gust {
namespace {

std::vector<double> values_of(const Matrix<double>& matrix, std::size_t row) {
  return {matrix.row(row).begin(), matrix.row(row).end()};
}

std::vector<Page::Trace> traces_of(const std::vector<Component>& components, const Matrix<double>& values) {
  std::vector<Page::Trace> traces;
  for (std::size_t i = 0; i < components.size(); ++i) {
    traces.push_back({components[i].name, components[i].unit, values_of(values, i)});
  }
  return traces;
}

/// What a site added, one trace a channel that was disturbed.
void add_pushes(Page::Episode& episode, Site site, const std::vector<Component>& channels,
                const Matrix<double>& values) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    std::vector<double> value = values_of(values, i);
    if (std::ranges::all_of(value, [](double v) { return v == 0.0; })) continue;
    episode.disturbances.push_back(
        {std::string(site_name(site)), {channels[i].name, channels[i].unit, std::move(value)}});
  }
}

/// What the policy saw beyond the true state before each of n control steps.
Matrix<double> seen_beyond(const Trace& trace) {
  Matrix<double> result(trace.state.rows(), trace.reward.size());
  for (std::size_t i = 0; i < result.rows(); ++i) {
    for (std::size_t k = 0; k < result.lanes(); ++k)
      result.at(i, k) = trace.observation.at(i, k) - trace.state.at(i, k);
  }
  return result;
}

Matrix<double> difference(const Matrix<double>& a, const Matrix<double>& b) {
  Matrix<double> result(a.rows(), a.lanes());
  for (std::size_t i = 0; i < a.rows(); ++i) {
    for (std::size_t k = 0; k < a.lanes(); ++k) result.at(i, k) = a.at(i, k) - b.at(i, k);
  }
  return result;
}

std::string failure_text(const Trace& trace, const PlantSpec& spec) {
  if (trace.failed_at < 0) return {};
  const auto column = static_cast<std::size_t>(trace.failed_at);
  for (std::size_t i = 0; i < spec.state.size(); ++i) {
    const double value = trace.state.at(i, column);
    if (!std::isfinite(value)) return cat(spec.state[i].name, " is not finite");
    if (value > spec.fail_high[i])
      return cat(spec.state[i].name, fmt::format(" > {:.3g} ", spec.fail_high[i]), spec.state[i].unit);
    if (value < spec.fail_low[i])
      return cat(spec.state[i].name, fmt::format(" < {:.3g} ", spec.fail_low[i]), spec.state[i].unit);
  }
  return {};
}

/// The parameters that drawing needs, as this cell has them.
std::vector<std::pair<std::string, double>> geometry_of(const SweepCell& cell, const PlantSpec& spec) {
  std::vector<std::pair<std::string, double>> geometry;
  for (std::size_t i = 0; i < spec.parameters.size(); ++i)
    geometry.emplace_back(spec.parameters[i].name, cell.parameters[i]);
  geometry.emplace_back("x_limit", spec.fail_high.front());
  geometry.emplace_back("action_limit", spec.action_high.front());
  return geometry;
}

/// A moving reference, one state for each of the trace's.
Matrix<double> reference_of(const Plant& plant, std::size_t states) {
  const PlantSpec& spec = plant.spec();
  Matrix<double> reference(spec.state.size(), states);
  std::vector<double> at(spec.state.size());
  for (std::size_t k = 0; k < states; ++k) {
    plant.reference(std::min(k, spec.references - 1), at);
    for (std::size_t i = 0; i < at.size(); ++i) reference.at(i, k) = at[i];
  }
  return reference;
}

bool touches_ground(const Plant& plant, const Trace& trace) {
  std::vector<double> state(trace.state.rows());
  for (std::size_t k = 1; k < trace.state.lanes(); ++k) {
    for (std::size_t i = 0; i < state.size(); ++i) state[i] = trace.state.at(i, k);
    if (plant.near_ground(state)) return true;
  }
  return false;
}

/// What a site's disturbances added, from their signals.
Matrix<double> added_at(Site site, std::size_t channels, const Trace& trace, const TrialEvaluation& task) {
  Matrix<double> added(channels, trace.reward.size());
  if (task.injections.empty()) return added;
  const std::shared_ptr<const Signals> signals = episode_signals(task.evaluation, trace.index);
  for (std::size_t i = 0; i < task.injections.size(); ++i) {
    if (task.injections[i].site != site) continue;
    const double factor = task.injections[i].factor(task.evaluation.cells[trace.index.cell].levels[i]);
    for (std::size_t c = 0; c < added.rows(); ++c) {
      for (std::size_t k = 0; k < added.lanes(); ++k) added.at(c, k) += factor * signals->channel(i, c)[k];
    }
  }
  return added;
}

/// What only a plant with equations of motion has.
void add_plant(Page::Episode& episode, const Plant& plant, const Trace& trace, const SweepCell& cell) {
  const PlantSpec& spec = plant.spec();
  episode.geometry = geometry_of(cell, spec);
  if (spec.references > 1) episode.reference = traces_of(spec.state, reference_of(plant, trace.state.lanes()));
  episode.touched_ground = touches_ground(plant, trace);
  episode.failure = failure_text(trace, spec);
}

/// Whether a trace has the shape that an episode of this evaluation has: what is read from a file may be anything.
bool fits(const Trace& trace, const Interface& spec, const Evaluation& evaluation) {
  const std::size_t steps = trace.reward.size();
  const auto is = [](const Matrix<double>& matrix, std::size_t rows, std::size_t lanes) {
    return matrix.rows() == rows && (rows == 0 || matrix.lanes() == lanes);
  };
  const EpisodeIndex& index = trace.index;
  const std::size_t actions = spec.tells_effort ? spec.action.size() : 0;
  return steps > 0 && index.cell < evaluation.cells.size() && index.start < evaluation.starts.size() &&
         index.episode >= 0 && index.episode < evaluation.episodes && trace.failed_at >= -1 &&
         trace.failed_at <= static_cast<std::int64_t>(steps) && is(trace.state, spec.state.size(), steps + 1) &&
         is(trace.observation, spec.observations(), steps + 1) && is(trace.commanded, actions, steps) &&
         is(trace.disturbed, actions, steps) && is(trace.applied, actions, steps) &&
         is(trace.force, spec.force.size(), steps) &&
         (trace.memory_of.empty() || is(trace.memory, trace.memory_of.size(), steps)) &&
         static_cast<std::int64_t>(steps) <= spec.steps;
}

Page::Episode page_episode(const Study& study, const Trial& trial, const Trace& trace, const TrialEvaluation& task) {
  const Interface& spec = study.setup.plant->spec();
  const StudyPolicy& policy = study.policies[trial.policy];
  Page::Episode episode;
  episode.policy = trial.policy;
  episode.start = trace.index.start;
  episode.plant = study.setup.plant.kind;
  episode.rate = spec.control_rate;
  episode.observed = spec.state.empty();
  episode.states =
      episode.observed ? traces_of(spec.measured(), trace.observation) : traces_of(spec.state, trace.state);
  if (trace.commanded.rows() > 0) episode.commanded = traces_of(spec.action, trace.commanded);
  if (trace.applied.rows() > 0) episode.applied = traces_of(spec.action, trace.applied);
  episode.memory = traces_of(trace.memory_of, trace.memory);
  if (const Plant* plant = study.setup.plant->plant())
    add_plant(episode, *plant, trace, task.evaluation.cells[trace.index.cell]);
  // What was added is the difference to the true state where that is what is measured; else the signals tell it. At the
  // action it is not recorded by itself where the command was clipped first. What an effect made of an action is the
  // difference to the command.
  const bool measures_state = !spec.state.empty() && spec.observation.empty();
  add_pushes(episode, Site::kObservation, spec.measured(),
             measures_state ? seen_beyond(trace) : added_at(Site::kObservation, spec.measured().size(), trace, task));
  const bool mapped = std::ranges::any_of(
      task.injections, [](const Injection& each) { return each.site == Site::kAction && each.is_effect(); });
  add_pushes(episode, Site::kAction, spec.action,
             mapped && trace.commanded.rows() > 0 ? difference(trace.disturbed, trace.commanded)
                                                  : added_at(Site::kAction, spec.action.size(), trace, task));
  add_pushes(episode, Site::kDynamics, spec.force, trace.force);
  episode.reward = trace.reward;
  if (trace.failed_at >= 0) episode.failed_step = static_cast<std::size_t>(trace.failed_at);
  const std::string seed = policy.training() ? cat(" seed ", policy.member(trial.member)) : "";
  const std::string sweep = trial.sweep == Trial::kNominal ? "undisturbed" : study.sweeps[trial.sweep].name;
  episode.title = cat(policy.name, seed, " · ", sweep);
  return episode;
}

}  // namespace

std::vector<Page::Episode> kept_episodes(const Study& study, const std::vector<KeptTraces>& kept,
                                         const std::vector<std::size_t>& sweep_at) {
  std::vector<Page::Episode> episodes;
  for (const auto& [policy, member, sweep, traces] : kept) {
    const std::string& name = study.policies[policy].name;
    const Error broken(cat("a kept episode of '", name, "' is of another study; run it again in another folder"));
    if (member >= study.policies[policy].count()) throw broken;
    const Trial trial{.policy = policy, .member = member, .sweep = sweep};
    const std::unique_ptr<TrialEvaluation> task = trial_evaluation(study, trial);
    for (const Trace& trace : traces) {
      if (!fits(trace, study.setup.plant->spec(), task->evaluation)) throw broken;
      Page::Episode episode = page_episode(study, trial, trace, *task);
      if (sweep != Trial::kNominal) {
        episode.sweep = sweep_at[sweep];
        const std::vector<Sweep::Axis>& axes = study.sweeps[sweep].axes;
        if (axes.size() == 1) episode.level = axes.front().values[trace.index.cell];
      }
      episodes.push_back(std::move(episode));
    }
  }
  return episodes;
}

}  // namespace gust
