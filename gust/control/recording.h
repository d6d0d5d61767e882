#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "gust/control/policy.h"
#include "gust/sim/plant.h"

namespace gust {

/// A run of a plant under a controller, as a simulator or a logger on a robot wrote it down, and the model of that
/// plant.
///
/// In every batch, lane k is record k: the action of control step k - 1, the force during it, and the state after it;
/// record 0 is the reset and has no action, force or outcome. SI units.
struct Recording {
  std::string name;
  Made<Plant> plant;                  ///< the model with the recorded parameters, rates, goal and reward weights
  std::string policy;                 ///< kind of the controller that acted; empty if it is not told
  std::vector<double> action_goal;    ///< u_goal: what the reward charges actions from; the plant's if not told
  Eigen::MatrixXd gain;               ///< K of u = u_goal - K (observation - goal), actions x states, of an "lqr"
  std::optional<Cascade> cascade;     ///< gains of a "pd"
  double goal_tolerance = 0;          ///< done when |state - goal| is below it; 0 for never
  bool exponential_reward = true;     ///< the reward is exp(-J), else -J
  std::vector<double> error_weights;  ///< v of the squared error sum (v e)^2

  std::vector<std::string> columns;  ///< of the CSV file
  std::vector<std::string> dropped;  ///< "obs1, obs2 (no obs0)": columns that are not used, as the first one is missing
  Matrix<double> state;
  Matrix<double>
      observation;           ///< what the controller saw: the state with noise, then references; empty if not recorded
  Matrix<double> command;    ///< what the controller asked for, in the policy's unit; of `disturbed` if not recorded
  Matrix<double> physical;   ///< the same in physical units
  Matrix<double> disturbed;  ///< after the action disturbance, before saturation; `applied` if not recorded
  Matrix<double> applied;    ///< what the plant received; `disturbed` saturated if not recorded
  Matrix<double> force;      ///< at the dynamics site, an adversary's share included; 0 if not recorded
  Matrix<double> outcome;    ///< rows: Recorded; 0 if not recorded

  std::size_t steps() const { return state.lanes() - 1; }
  /// Whether the file has this column; of several actions the first one.
  bool has(std::string_view column) const;
  /// Whether it tells what the controller asked for, in either unit.
  bool commanded() const { return has("a_raw") || has("a_phys"); }
  /// The controller, if it is one that can be run again; else null.
  std::unique_ptr<Policy> controller() const;
};

/// Rows of Recording::outcome. The flags are 0 or 1.
enum class Recorded { kReward, kSquaredError, kOutOfBounds, kDone, kTimeLimit };

/// A file that was read: its bytes, and its name for messages.
struct NamedBytes {
  std::string_view bytes;
  std::string name;
};

/// Reads a recording from its description (JSON) and its records (CSV); recording_format() tells what they hold. States
/// and an action are needed, the rest where it is to be judged. Throws Error with file, line and column for whatever is
/// needed and missing, misspelt, no number, or does not fit together.
Recording read_recording(const NamedBytes& description, const NamedBytes& records);

/// The columns of the external force, or of what else `prefix` names: "f_x" for the force "fx".
std::vector<std::string> force_columns(const std::string& prefix, const PlantSpec& spec);

/// The format as help text: every key of the JSON file and every column of the CSV file.
std::string recording_format();

}  // namespace gust
