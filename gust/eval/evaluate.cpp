#include "gust/eval/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace gust {
namespace {

Rng episode_streams(const Evaluation& evaluation) { return evaluation.root.split("evaluation"); }

SignalSequence sequence_of(const Evaluation& evaluation, std::size_t cell) {
  return {evaluation.injections, evaluation.plant->spec(), evaluation.cells[cell].levels, episode_streams(evaluation)};
}

/// The disturbances of each episode, drawn when first asked for: of all cells at once where levels scale them.
class SignalStore {
 public:
  explicit SignalStore(const Evaluation& evaluation)
      : evaluation_(evaluation),
        shared_(all_scale(evaluation.injections)),
        drawn_(static_cast<std::size_t>(shared_ ? evaluation.episodes : 0)) {}

  std::shared_ptr<const Signals> at(const EpisodeIndex& index) {
    if (!sequence_ || (!shared_ && index.cell != cell_)) sequence_.emplace(sequence_of(evaluation_, index.cell));
    cell_ = index.cell;
    if (!shared_) return sequence_->at(index.episode);
    auto& signals = drawn_[static_cast<std::size_t>(index.episode)];
    if (!signals) signals = sequence_->at(index.episode);
    return signals;
  }

 private:
  const Evaluation& evaluation_;
  bool shared_;
  std::vector<std::shared_ptr<const Signals>> drawn_;
  std::optional<SignalSequence> sequence_;
  std::size_t cell_ = 0;
};

EpisodeStart start_of(const Evaluation& evaluation, const EpisodeIndex& index, SignalStore& signals) {
  const SweepCell& cell = evaluation.cells[index.cell];
  EpisodeStart start;
  start.state = start_state(evaluation, index);
  start.parameters = cell.parameters;
  start.levels = cell.levels;
  start.signals = signals.at(index);
  return start;
}

/// Whether all episodes of a start are one and the same: nothing in them is drawn.
bool repeats(const Evaluation& evaluation, std::size_t start) {
  const bool noisy = std::any_of(evaluation.injections.begin(), evaluation.injections.end(),
                                 [](const Injection& injection) { return injection.random(); });
  return !noisy && !evaluation.starts[start].random;
}

/// Runs these episodes side by side to the end of the horizon.
std::vector<Episode> run_batch(const Evaluation& evaluation, Policy& policy, SignalStore& signals,
                               std::span<const EpisodeIndex> indices) {
  const PlantSpec& spec = evaluation.plant->spec();
  ClosedLoop loop(*evaluation.plant, evaluation.readings, evaluation.injections, indices.size());
  EpisodeMeter meter(spec, indices.size());
  Matrix<double> action(spec.action.size(), indices.size());
  for (std::size_t lane = 0; lane < indices.size(); ++lane) {
    loop.begin(lane, start_of(evaluation, indices[lane], signals));
  }
  for (std::int64_t k = 0; k < spec.steps; ++k) {
    policy.act(loop.observation(), loop.steps_done(), action.view());
    loop.step(action.view());
    meter.record(loop);
  }
  std::vector<Episode> episodes;
  for (std::size_t lane = 0; lane < indices.size(); ++lane) episodes.push_back(meter.episode(lane));
  return episodes;
}

}  // namespace

Rng episode_stream(const Evaluation& evaluation, std::int64_t episode) {
  return episode_streams(evaluation).split(static_cast<std::uint64_t>(episode));
}

void evaluate(const Evaluation& evaluation, Policy& policy,
              const std::function<void(const EpisodeIndex&, const Episode&)>& take, std::size_t lanes) {
  SignalStore signals(evaluation);
  std::vector<EpisodeIndex> batch;
  const auto flush = [&] {
    const std::vector<Episode> episodes = run_batch(evaluation, policy, signals, batch);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const std::int64_t copies = repeats(evaluation, batch[i].start) ? evaluation.episodes : 1;
      for (std::int64_t copy = 0; copy < copies; ++copy) {
        take({batch[i].cell, batch[i].start, batch[i].episode + copy}, episodes[i]);
      }
    }
    batch.clear();
  };
  for (std::size_t cell = 0; cell < evaluation.cells.size(); ++cell) {
    for (std::size_t start = 0; start < evaluation.starts.size(); ++start) {
      const std::int64_t distinct = repeats(evaluation, start) ? 1 : evaluation.episodes;
      for (std::int64_t episode = 0; episode < distinct; ++episode) {
        batch.push_back({cell, start, episode});
        if (batch.size() == lanes) flush();
      }
    }
  }
  if (!batch.empty()) flush();
}

std::vector<double> start_state(const Evaluation& evaluation, const EpisodeIndex& index) {
  const StartProtocol& protocol = evaluation.starts[index.start];
  if (!protocol.random) return protocol.state;
  return random_start(evaluation.plant->spec(), episode_stream(evaluation, index.episode));
}

std::optional<NotFiniteAction> not_finite_action(const Evaluation& evaluation, const EpisodeIndex& index,
                                                 const Episode& episode) {
  std::optional<NotFiniteAction> action = episode.not_finite;
  if (action && action->state.empty()) action->state = start_state(evaluation, index);
  return action;
}

std::shared_ptr<const Signals> episode_signals(const Evaluation& evaluation, const EpisodeIndex& index) {
  return sequence_of(evaluation, index.cell).at(index.episode);
}

Trace trace_episode(const Evaluation& evaluation, Policy& policy, const EpisodeIndex& index) {
  const PlantSpec& spec = evaluation.plant->spec();
  const auto steps = static_cast<std::size_t>(spec.steps);
  SignalStore signals(evaluation);
  ClosedLoop loop(*evaluation.plant, evaluation.readings, evaluation.injections, 1);
  Matrix<double> action(spec.action.size(), 1);
  Trace trace;
  trace.index = index;
  trace.state = Matrix<double>(spec.state.size(), steps + 1);
  trace.observation = Matrix<double>(spec.observations(), steps + 1);
  trace.commanded = trace.disturbed = trace.applied = Matrix<double>(spec.action.size(), steps);
  trace.force = Matrix<double>(spec.force.size(), steps);
  trace.memory_of = policy.memory();
  trace.memory = Matrix<double>(trace.memory_of.size(), steps);

  const auto keep = [](Matrix<double>& to, Rows<const double> from, std::size_t column) {
    for (std::size_t i = 0; i < from.rows; ++i) to.at(i, column) = from.at(i, 0);
  };
  loop.begin(0, start_of(evaluation, index, signals));
  keep(trace.state, loop.state(), 0);
  keep(trace.observation, loop.observation(), 0);
  for (std::size_t k = 0; k < steps; ++k) {
    policy.act(loop.observation(), loop.steps_done(), action.view());
    keep(trace.memory, policy.remembered(), k);
    loop.step(action.view());
    keep(trace.state, loop.state(), k + 1);
    keep(trace.observation, loop.observation(), k + 1);
    keep(trace.commanded, loop.commanded(), k);
    keep(trace.disturbed, loop.disturbed(), k);
    keep(trace.applied, loop.applied(), k);
    keep(trace.force, loop.force(), k);
    trace.reward.push_back(loop.reward()[0]);
    if (loop.failed(0) && trace.failed_at < 0) trace.failed_at = static_cast<std::int64_t>(k) + 1;
  }
  return trace;
}

StartProtocol nominal_start(const PlantSpec& spec) { return {"nominal", false, spec.start}; }
StartProtocol random_starts() { return {"random", true, {}}; }

std::string start_complaint(const StartProtocol& start, const PlantSpec& spec) {
  for (std::size_t i = 0; start.random && i < spec.state.size(); ++i) {
    const double middle = spec.start[i] + spec.start_offset[i], range = spec.start_range[i];
    if (middle + range >= spec.fail_low[i] && middle - range <= spec.fail_high[i]) continue;
    return fmt::format("random starts have {} = {:.4g} to {:.4g}, outside the safe set, {:.4g} to {:.4g} {}",
                       spec.state[i].name, middle - range, middle + range, spec.fail_low[i], spec.fail_high[i],
                       spec.state[i].unit);
  }
  for (std::size_t i = 0; i < start.state.size(); ++i) {
    if (start.state[i] >= spec.fail_low[i] && start.state[i] <= spec.fail_high[i]) continue;
    return fmt::format(
        "{} = {} lies outside the safe set, {:.4g} to {:.4g} {}: the episode would fail before its first step",
        spec.state[i].name, start.state[i], spec.fail_low[i], spec.fail_high[i], spec.state[i].unit);
  }
  return "";
}

}  // namespace gust
