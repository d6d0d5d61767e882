#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "gust/core/value.h"

namespace gust {

/// A named scalar with its unit.
struct Component {
  std::string name;
  std::string unit;
};

/// The values from low to high.
struct Limits {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// A physical quantity of the plant that a study may set, scale or randomise.
struct Parameter {
  std::string name;
  std::string unit;
  double nominal = 0;
  // Where the plant can be held at its goal at all, the other parameters being nominal.
  Limits by_actuator = {};  ///< with all that the actuator gives
  Limits by_box = {};       ///< with commands that are clipped to the policy's action box
};

/// What a loop can tell of an episode beside its rewards, and what a metric needs of it.
struct Told {
  bool state = false;          ///< the true state
  bool goal = false;           ///< what the state should be
  bool effort = false;         ///< what the actuator was asked for and what it gave
  bool force = false;          ///< forces at the dynamics site
  bool failure = false;        ///< whether the episode failed
  bool after_failure = false;  ///< what happens when failure ends nothing

  /// Whether all that is needed is told.
  bool covers(const Told& needs) const;
};

/// What is needed and not told, for people: "no true state, no goal".
std::string untold_text(const Told& told, const Told& needs);

/// What is seen, done and disturbed in an episode, and for how long, whatever makes it happen: equations of motion or
/// an environment of somebody else. SI units.
struct Interface {
  std::vector<Component> state;        ///< the true state; none: nobody can tell it
  std::vector<Component> observation;  ///< what is measured, if that is not the state
  std::size_t horizon = 0;             ///< later samples of the reference that follow in what the policy sees
  std::vector<Component> action;       ///< physical inputs
  std::vector<Component> force;        ///< the dynamics site; none: there is no such site
  std::vector<Parameter> parameters;

  double control_rate = 0;  ///< Hz
  std::int64_t steps = 0;   ///< control steps in an episode

  bool normalized_action = false;    ///< the policy acts in [-1, 1]
  std::vector<double> action_scale;  ///< physical = action_offset + action_scale * the policy's action
  std::vector<double> action_offset;
  std::vector<double> action_low;  ///< physical bounds of the actuator
  std::vector<double> action_high;

  Limits reward = {0, 1};             ///< of one control step
  std::vector<double> error_weights;  ///< of state components in rmse_scg; none: there is no goal
  std::size_t angle = 0;              ///< the state component that is the attitude
  bool tells_effort = true;           ///< what the actuator was asked for and what it gave
  bool fails = true;                  ///< whether an episode can fail
  bool ground = false;                ///< whether it can touch the ground
  bool goes_on = true;                ///< whether steps after a failure mean anything

  /// What is measured: the first numbers that a policy sees, and the channels of the observation site.
  const std::vector<Component>& measured() const { return observation.empty() ? state : observation; }
  /// Numbers that a policy sees: what is measured, then `horizon` references.
  std::size_t observations() const { return measured().size() * (1 + horizon); }
  std::string action_unit() const { return normalized_action ? "normalised" : action.front().unit; }
  Told told() const;
};

/// The nominal parameters, in the order of the interface.
std::vector<double> nominal_parameters(const Interface& spec);

/// The position of a parameter; an Error at the place if there is none of that name.
std::size_t parameter_index(const Interface& spec, const std::string& name, const Place& place);

}  // namespace gust
