#pragma once

#include "gust/control/disturber.h"
#include "gust/control/readings.h"

namespace gust {

/// The way of a command to the plant, lane by lane: it is brought to physical units, clipped to the policy's box where
/// the readings ask for it, disturbed, and clipped to the actuator's bounds. Every loop may use it.
class Actuator {
 public:
  /// The interface must outlive it. `splits` says that an action may change within a step (Disturber::may_split).
  Actuator(const Interface& spec, const Readings& readings, std::size_t lanes, bool splits = false);

  /// Takes the commands of a control step, actions x lanes in the policy's unit. `step` tells the control steps that
  /// each lane's episode has behind it; `offset` is an adversary's share.
  void act(Rows<const double> command, std::span<const std::int64_t> step, Disturber& disturber,
           Rows<const double> offset = {}) noexcept;

  /// Of the last step: what was commanded (clipped to the actuator's bounds), what the disturbance made of it, and
  /// what the plant received; physical units.
  Rows<const double> commanded() const { return commanded_.view(); }
  Rows<const double> disturbed() const { return disturbed_.view(); }
  Rows<const double> applied() const { return applied_.view(); }
  /// What the plant receives before the change, where the action changes within a step (Disturber::split).
  Rows<const double> applied_early() const { return early_applied_.view(); }
  /// 0 in every lane whose last command was finite, else the NaN or infinity in it.
  std::span<const double> not_finite() const { return not_finite_; }

 private:
  void command(Rows<const double> command) noexcept;
  void saturate(const Matrix<double>& wanted, Matrix<double>& applied) const noexcept;

  const Interface& spec_;
  bool boxed_;      // the command is clipped to its box before anything is added
  bool saturates_;  // the disturbed sum is clipped to the actuator's bounds
  std::vector<double> not_finite_;
  Matrix<double> command_, commanded_, disturbed_, applied_;
  Matrix<double> early_, early_applied_;  // empty where nothing changes within a step
};

}  // namespace gust
