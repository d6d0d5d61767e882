#pragma once

#include "gust/control/recording.h"

namespace gust {

/// The largest error that still counts as agreement, in the unit of what is compared.
struct Tolerances {
  double step = 1e-12;  ///< after one control step, and of the reward and the applied action
  double loop = 1e-10;  ///< at any step of a closed loop run from the first state on
};

/// An error, and the record in which it is the largest. NaN counts as infinitely wrong.
struct WorstError {
  double error = 0;
  std::size_t record = 0;

  void take(double difference, std::size_t at);
};

/// What a recording has enough of to be judged, besides its states one step ahead.
struct JudgedParts {
  bool applied = false;        ///< a_applied, and the action before saturation
  bool reward = false;         ///< the reward, and the action that it charges
  bool squared_error = false;  ///< sq_err
  bool out_of_bounds = false, done = false, time_limit = false;
  bool closed_loop = false;  ///< a controller that can be run again, what it saw and what it asked for

  bool flags() const { return out_of_bounds || done || time_limit; }
};

/// How a recording and the model of its plant agree.
struct Validation {
  JudgedParts parts;
  std::vector<WorstError> one_step;     ///< of each state, restarted from every recorded state
  std::vector<WorstError> closed_loop;  ///< of each state, in a run of its own; empty for an open loop
  WorstError applied;                   ///< of the action after disturbance and saturation
  WorstError reward;
  WorstError squared_error;      ///< relative where it is above 1
  std::size_t flags_differ = 0;  ///< records with another out_of_bounds, done or timelimit
  std::size_t first_flag = 0;    ///< the first of them
  WorstError reference;          ///< of the references in the observation
  std::size_t judged = 0;        ///< steps that were compared: all, or those before the ground may have been touched
  std::string fault;             ///< the first thing that is beyond its tolerance, as a sentence; empty if passed

  /// Nothing that was compared is wrong, and something was compared.
  bool passed() const { return fault.empty() && judged > 0; }
};

/// "reward, flags": what of a recording was not judged because its file has no columns for it; empty if all was.
std::string not_recorded(const Recording& recording, const JudgedParts& parts);

/// "no force", "no f_z": external forces that are not recorded; empty if all are.
std::string missing_forces(const Recording& recording);

/// Runs the model against the recording, as far as it goes. One step: from every recorded state with the recorded
/// applied action and force, and once more through the closed loop's own order of disturbance, saturation, reward and
/// failure. Closed loop, where the recorded controller can be run again: that controller on the model's own state with
/// the recorded noise of observations and actions and the recorded forces. Contact with the ground is not modelled
/// exactly: the comparison ends before it, and where nothing comes before it nothing has passed.
Validation validate(const Recording& recording, const Tolerances& tolerances);

}  // namespace gust
