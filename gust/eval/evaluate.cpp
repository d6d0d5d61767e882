#include "gust/eval/evaluate.h"

#include <algorithm>
#include <optional>

namespace gust {
namespace {

Rng episode_streams(const Evaluation& evaluation) { return evaluation.root.split("evaluation"); }

SignalSequence sequence_of(const Evaluation& evaluation, std::size_t cell) {
  return {evaluation.injections, evaluation.source->spec(), evaluation.cells[cell].levels, episode_streams(evaluation)};
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
  const std::unique_ptr<Loop> loop = evaluation.source->make(evaluation.injections, indices.size());
  EpisodeMeter meter(loop->spec(), indices.size());
  std::vector<EpisodeStart> starts;
  for (const EpisodeIndex& index : indices) starts.push_back(start_of(evaluation, index, signals));
  run_episodes(*loop, policy, starts, [&](std::int64_t steps) {
    if (steps > 0) meter.record(loop->record());
  });
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
  return evaluation.source->start_state(evaluation.starts[index.start], episode_stream(evaluation, index.episode));
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
  SignalStore signals(evaluation);
  const EpisodeStart start = start_of(evaluation, index, signals);
  const std::unique_ptr<Loop> loop = evaluation.source->make(evaluation.injections, 1);
  const auto steps = static_cast<std::size_t>(loop->spec().steps);
  Trace trace;
  trace.index = index;
  trace.memory_of = policy.memory();
  const auto keep = [](Matrix<double>& to, Rows<const double> from, std::size_t column, std::size_t columns) {
    if (column == 0) to = Matrix<double>(from.rows, columns);
    for (std::size_t i = 0; i < from.rows; ++i) to.at(i, column) = from.at(i, 0);
  };
  run_episodes(*loop, policy, {&start, 1}, [&](std::int64_t done) {
    const StepRecord record = loop->record();
    const auto now = static_cast<std::size_t>(done);
    keep(trace.state, record.state, now, steps + 1);
    keep(trace.observation, loop->observation(), now, steps + 1);
    if (done == 0) return;
    keep(trace.commanded, record.commanded, now - 1, steps);
    keep(trace.disturbed, record.disturbed, now - 1, steps);
    keep(trace.applied, record.applied, now - 1, steps);
    keep(trace.force, record.force, now - 1, steps);
    keep(trace.memory, policy.remembered(), now - 1, steps);
    trace.reward.push_back(record.reward[0]);
    if (trace.failed_at < 0 && !record.failed.empty() && record.failed[0] != 0) trace.failed_at = done;
  });
  return trace;
}

}  // namespace gust
