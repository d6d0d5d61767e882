#pragma once

#include <span>

#include "gust/control/disturber.h"
#include "gust/control/readings.h"
#include "gust/sim/plant.h"

namespace gust {

/// Which action the reward charges; see Readings.
enum class Effort { kCommanded, kDisturbed, kApplied };

/// What is added at the sites beside the disturbances, in physical units: an adversary's share, or one that was
/// recorded. Absent rows are zero.
struct Offsets {
  Rows<const double> observation = {};  ///< to the state part of the observation after the step
  Rows<const double> action = {};
  Rows<const double> force = {};
};

/// A batch of episodes, one a lane, stepped together: the only place where plant, disturbance and command meet.
///
/// Every lane is by itself: it begins, ends and begins again without touching the others, and its bits do not depend
/// on them. The plant and the injections must outlive the loop.
class ClosedLoop {
 public:
  ClosedLoop(const Plant& plant, const Readings& readings, std::span<const Injection> injections, std::size_t lanes);

  /// Puts a lane at the start of an episode; its first observation is there afterwards.
  void begin(std::size_t lane, const EpisodeStart& start);

  /// One control step of every lane with these commands (actions x lanes, in the policy's unit).
  void step(Rows<const double> command, const Offsets& offsets = {}) noexcept;

  const Plant& plant() const { return plant_; }
  std::size_t lanes() const { return lanes_; }
  /// Control steps done in this lane's episode.
  std::int64_t steps_done(std::size_t lane) const { return counter_[lane]; }
  std::span<const std::int64_t> steps_done() const { return counter_; }

  /// What the policy sees now: the disturbed state, then the references ahead; spec().observations() x lanes.
  Rows<const double> observation() const { return observation_.view(); }
  /// The true state after the last step.
  Rows<const double> state() const { return state_.view().first_rows(plant_.spec().state.size()); }
  /// The reference that the last step's reward compared with.
  Rows<const double> goal() const { return goal_.view(); }
  /// Of the last step: what was commanded (clipped to the actuator's bounds), what the disturbance made of it, and
  /// what the plant received; physical units.
  Rows<const double> commanded() const { return commanded_.view(); }
  Rows<const double> disturbed() const { return disturbed_.view(); }
  Rows<const double> applied() const { return applied_.view(); }
  /// The force at the dynamics site during the last step.
  Rows<const double> force() const { return force_.view(); }
  /// Reward of the last step, charged with the effort that the readings name.
  std::span<const double> reward() const;
  /// Rewards of the last step under both readings that recordings have: commanded and disturbed effort.
  std::span<const double> reward_commanded() const { return reward_commanded_.row(0); }
  std::span<const double> reward_disturbed() const { return reward_disturbed_.row(0); }
  /// 0 if the last command was finite, else the NaN or infinity in it.
  double not_finite_command(std::size_t lane) const { return not_finite_[lane]; }
  /// Whether the true state has left the safe set in the last step, or is not finite.
  bool failed(std::size_t lane) const { return failed_[lane]; }
  /// Whether the plant has touched the ground since its episode began.
  bool touched_ground(std::size_t lane) const {
    return plant_.spec().contact && state_.at(*plant_.spec().contact, lane) != 0.0;
  }

 private:
  void command_actions(Rows<const double> command) noexcept;
  void disturb_actions(Rows<const double> offset) noexcept;
  void saturate_actions() noexcept;
  void saturate(const Matrix<double>& wanted, Matrix<double>& applied) const noexcept;
  void set_forces(Rows<const double> offset) noexcept;
  void advance() noexcept;
  void judge() noexcept;
  void charge(Rows<const double> action, std::span<double> reward) const noexcept;
  void observe(Rows<const double> offset) noexcept;
  void show_references(std::size_t lane) noexcept;
  void set_goal() noexcept;
  std::span<const double> reference(std::int64_t sample) const noexcept;

  const Plant& plant_;
  Effort effort_;
  bool boxed_;      // the command is clipped to its box before anything is added
  bool saturates_;  // the disturbed sum is clipped to the actuator's bounds
  Disturber disturber_;
  std::size_t lanes_;
  std::vector<double> references_;  // state by state
  std::vector<std::int64_t> counter_;
  std::vector<std::uint8_t> failed_;
  std::vector<double> not_finite_;
  Matrix<double> state_, parameters_, goal_, observation_;
  Matrix<double> command_, commanded_, disturbed_, applied_, force_;
  // Where signals change within a control step: what comes before the change, and after how many substeps it lies.
  Matrix<double> early_action_, early_applied_, early_force_, early_observation_, substeps_;
  Matrix<double> reward_commanded_, reward_disturbed_, reward_applied_, cost_;
};

/// The plant's nominal parameters, in the order of its spec.
std::vector<double> nominal_parameters(const PlantSpec& spec);

/// A start state of the training distribution: nominal plus uniform, drawn from the episode's stream.
std::vector<double> random_start(const PlantSpec& spec, Rng episode);

}  // namespace gust
