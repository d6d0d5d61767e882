#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gust/core/catalog.h"
#include "gust/core/rows.h"

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

/// A cascade of two proportional-derivative loops: the outer one asks for an attitude, the inner one brings it about.
/// With e = reference - state, the attitude's reference is clip(outer . e, -limit, limit), and then
/// action = rest + inner e. All of it is what the controller believes of the plant, which may be wrong.
struct Cascade {
  std::vector<double> outer;  ///< per state component
  double limit = 0;           ///< rad
  Eigen::MatrixXd inner;      ///< actions x states, physical
  Eigen::VectorXd rest;       ///< action without an error, physical
};

/// Everything about a plant and its task that is data: what is measured, pushed, charged and forbidden. SI units.
struct PlantSpec {
  std::vector<Component> state;   ///< also what is observed
  std::size_t horizon = 0;        ///< reference states that follow the state in the observation
  std::size_t references = 1;     ///< states of the reference, one a control step from the reset on; 1: a goal to hold
  std::size_t reference_lag = 0;  ///< the state after n steps is compared with reference n - lag
  std::vector<Component> action;  ///< physical inputs
  std::vector<Component> force;   ///< the dynamics site
  std::vector<Parameter> parameters;
  std::size_t hidden = 0;              ///< rows of integrator memory that follow the state
  std::optional<std::size_t> contact;  ///< the hidden row that is 1 once the plant has touched the ground

  double control_rate = 0;  ///< Hz
  double physics_rate = 0;  ///< Hz, a multiple of control_rate
  std::int64_t steps = 0;   ///< control steps in an episode

  bool normalized_action = false;    ///< the policy acts in [-1, 1]
  std::vector<double> action_scale;  ///< physical = action_offset + action_scale * the policy's action
  std::vector<double> action_offset;
  std::vector<double> action_low;  ///< physical bounds of the actuator
  std::vector<double> action_high;

  std::vector<double> start;         ///< nominal initial state
  std::vector<double> start_offset;  ///< training starts at start + start_offset + U(±start_range)
  std::vector<double> start_range;
  std::vector<double> fail_low;  ///< the episode fails outside [fail_low, fail_high]
  std::vector<double> fail_high;
  std::vector<bool> wraps;  ///< the error of this component is taken modulo a turn in the reward

  std::vector<double> state_weights;  ///< of the reward exp(-J), J = sum w e^2 + w_u sum (u - u_goal)^2
  double action_weight = 0;           ///< per squared physical unit of the action
  std::vector<double> action_goal;    ///< what holds the goal; physical
  std::vector<double> error_weights;  ///< components that count in rmse_scg
  std::size_t angle = 0;              ///< the state component that is the attitude
  std::optional<Cascade> cascade;     ///< of a controller that is known to work, if one is

  /// Numbers that a policy sees: the state, then `horizon` references.
  std::size_t observations() const { return state.size() * (1 + horizon); }
  std::string action_unit() const { return normalized_action ? "normalised" : action.front().unit; }
};

/// A control step within which signals change, and of which a state before its end is seen. Counts of substeps are
/// whole numbers, by lane.
struct SplitStep {
  Rows<const double> action, force;              ///< what acts in the first substeps
  Rows<const double> action_until, force_until;  ///< how many these are
  Rows<const double> seen_after;                 ///< after how many the visible state is written to `seen`
  Rows<double> seen;
};

/// A batch of plants in motion; every view has the same lanes. State rows: visible components, then hidden ones.
struct Motion {
  Rows<double> state;
  Rows<const double> parameters;
  Rows<const double> action;  ///< physical, saturated as it acts
  Rows<const double> force;
  const SplitStep* split = nullptr;
};

/// x(k+1) - x* = A (x(k) - x*) + B (u(k) - u*), over one control step.
struct Linearisation {
  Eigen::MatrixXd a;
  Eigen::MatrixXd b;
};

/// The equations of motion of a plant with its task. Immutable; what changes is passed in.
class Plant {
 public:
  virtual ~Plant() = default;

  virtual const PlantSpec& spec() const = 0;

  /// Advances every lane by one control step of spec().physics_rate / spec().control_rate substeps. Whole packs are
  /// run: rows must be padded as Matrix pads them. The bits of a lane do not depend on the other lanes.
  virtual void advance(const Motion& motion) const noexcept = 0;

  /// Writes state `sample` of the reference, of those that there are.
  virtual void reference(std::size_t sample, std::span<double> state) const noexcept = 0;

  /// Sets the hidden rows of one lane from its visible state: at rest before the start of an episode, or as if it had
  /// come by itself to where it is.
  virtual void begin(Rows<double> state, std::size_t lane, bool moving) const noexcept = 0;

  /// Whether the ground may touch the plant in this state: what follows is an approximation of a contact.
  virtual bool near_ground(std::span<const double> state) const noexcept = 0;

  /// The exact derivative of one control step (dual numbers), at a state and a physical action, nominal parameters.
  virtual Linearisation linearise(std::span<const double> state, std::span<const double> action) const = 0;
};

/// The position of a parameter of the plant; an Error at the place if there is none of that name.
std::size_t parameter_index(const PlantSpec& spec, const std::string& name, const Place& place);

/// Every plant there is, in the order of plants/list.inc.
const Catalog<Plant>& plants();

}  // namespace gust
