#pragma once

#include <optional>

#include "gust/agents/agent.h"
#include "gust/agents/archive.h"
#include "gust/control/adversary.h"

namespace gust {

/// The environments of a training, stepped together. An episode that ends, by failure or at its last step, is followed
/// at once by the next of the same environment (docs/algorithms.md 7.2).
///
/// Episode n of environment i has its own random streams for start, parameters and disturbances: nothing else moves
/// them.
class Environments {
 public:
  /// The task must outlive the environments. `against` is where an adversary acts, if there is one.
  Environments(const TrainingTask& task, std::size_t count, Rng rng, const std::optional<AdversarySite>& against = {});

  std::size_t count() const { return episodes_.size(); }
  const PlantSpec& spec() const { return task_.plant->spec(); }

  /// What the policy sees now; of an environment whose episode just ended, the first of the next episode.
  Rows<const double> observation() const { return loop_.observation(); }

  /// Numbers of an adversary's action; 0 without one.
  std::size_t channels() const { return value_.rows(); }

  /// One step with these commands, actions x environments in the policy's unit, and these actions of the adversary,
  /// channels x environments.
  void step(Rows<const double> command, Rows<const double> adversary = {});

  /// Begins the next episode of every environment.
  void restart();

  // Of the last step.
  std::span<const double> reward() const { return reward_; }
  std::span<const std::uint8_t> done() const { return done_; }
  /// Ended by time alone: the state after it still has a value.
  std::span<const std::uint8_t> truncated() const { return truncated_; }
  /// The last observation of the episodes that ended; other lanes hold old numbers.
  Rows<const double> terminal_observation() const { return terminal_.view(); }

  /// An episode is kept as its number and what was done in it; the loader runs it again.
  void save(Saver& saver) const;
  void load(Loader& loader);

 private:
  void begin(std::size_t lane);
  void next(std::size_t lane);
  void move(Rows<const double> command, Rows<const double> adversary);
  void replay();

  TrainingTask task_;
  Rng rng_;
  std::optional<AdversarySite> against_;
  ClosedLoop loop_;
  std::vector<SignalSequence> signals_;
  std::vector<std::uint64_t> episodes_;       // number of each environment's present episode
  std::vector<std::vector<double>> history_;  // its commands and adversary's actions so far, step by step
  std::vector<double> reward_;
  std::vector<std::uint8_t> done_;
  std::vector<std::uint8_t> truncated_;
  Matrix<double> terminal_;
  Matrix<double> value_;  // what the adversary adds at its site
};

}  // namespace gust
