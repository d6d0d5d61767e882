#pragma once

#include <functional>
#include <span>

#include "gust/control/episode.h"
#include "gust/control/loop_source.h"

namespace gust {

/// One cell of a sweep: how strong each injection is and what the parameters are.
struct SweepCell {
  std::vector<double> levels;      ///< one per injection
  std::vector<double> parameters;  ///< in the order of the interface
};

/// What to measure: every cell from every start, `episodes` times. The source and the injections must outlive it.
struct Evaluation {
  const LoopSource* source = nullptr;
  std::span<const Injection> injections;
  std::vector<SweepCell> cells;
  std::vector<StartProtocol> starts;
  std::int64_t episodes = 25;
  Rng root{0};  ///< of the study; policies, levels and lanes never change which noise an episode meets
};

/// The streams of an episode: shared by every policy, level and start.
Rng episode_stream(const Evaluation& evaluation, std::int64_t episode);

/// Names one episode of an evaluation.
struct EpisodeIndex {
  std::size_t cell = 0;
  std::size_t start = 0;
  std::int64_t episode = 0;
};

/// Runs everything, lanes side by side, and hands over each episode in the order cell, start, episode.
/// Equal arguments give equal bits for any number of lanes at a time.
void evaluate(const Evaluation& evaluation, Policy& policy,
              const std::function<void(const EpisodeIndex&, const Episode&)>& take, std::size_t lanes = 256);

/// EpisodeStart::state of an episode of an evaluation: of a plant the true state in which it begins.
std::vector<double> start_state(const Evaluation& evaluation, const EpisodeIndex& index);

/// The first action of an episode that was NaN or infinite, with the state in which it was given.
std::optional<NotFiniteAction> not_finite_action(const Evaluation& evaluation, const EpisodeIndex& index,
                                                 const Episode& episode);

/// What disturbs an episode of an evaluation, to be multiplied by Injection::factor(level); null if nothing does.
std::shared_ptr<const Signals> episode_signals(const Evaluation& evaluation, const EpisodeIndex& index);

/// Everything that happened in one episode, step by step; columns are control steps. What the loop does not tell has no
/// rows.
struct Trace {
  EpisodeIndex index;
  Matrix<double> state;        ///< before step 0 and after every step: horizon + 1 columns
  Matrix<double> observation;  ///< what the policy saw, horizon + 1 columns
  Matrix<double> commanded, disturbed, applied, force;
  std::vector<Component> memory_of;  ///< what the policy keeps from step to step; none of most policies
  Matrix<double> memory;             ///< that, after every action
  std::vector<double> reward;
  std::int64_t failed_at = -1;  ///< number of steps done when it failed, -1 if it did not
};

/// Runs one episode of an evaluation again and keeps all of it.
Trace trace_episode(const Evaluation& evaluation, Policy& policy, const EpisodeIndex& index);

}  // namespace gust
