#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gust/core/catalog.h"
#include "gust/core/rows.h"
#include "gust/sim/interface.h"

namespace gust {

/// A cascade of two proportional-derivative loops: the outer one asks for an attitude, the inner one brings it about.
/// With e = reference - state, the attitude's reference is clip(outer . e, -limit, limit), and then
/// action = rest + inner e. All of it is what the controller believes of the plant, which may be wrong.
struct Cascade {
  std::vector<double> outer;  ///< per state component
  double limit = 0;           ///< rad
  Eigen::MatrixXd inner;      ///< actions x states, physical
  Eigen::VectorXd rest;       ///< action without an error, physical
};

/// What is asked of a plant: where episodes begin, when they fail, what is rewarded and what the state is compared
/// with.
struct Task {
  std::vector<double> start;         ///< nominal initial state
  std::vector<double> start_offset;  ///< training starts at start + start_offset + U(±start_range)
  std::vector<double> start_range;
  std::vector<double> fail_low;  ///< the episode fails outside [fail_low, fail_high]
  std::vector<double> fail_high;
  std::vector<bool> wraps;  ///< the error of this component is taken modulo a turn in the reward

  std::size_t references = 1;     ///< states of the reference, one a control step from the reset on; 1: a goal to hold
  std::size_t reference_lag = 0;  ///< the state after n steps is compared with reference n - lag

  std::vector<double> state_weights;  ///< of the reward exp(-J), J = sum w e^2 + w_u sum (u - u_goal)^2
  double action_weight = 0;           ///< per squared physical unit of the action
  std::vector<double> action_goal;    ///< what holds the goal; physical
};

/// Everything about a plant that is data: its interface, its task, and what the physics needs.
struct PlantSpec : Interface, Task {
  double physics_rate = 0;             ///< Hz, a multiple of control_rate
  std::size_t hidden = 0;              ///< rows of integrator memory that follow the state
  std::optional<std::size_t> contact;  ///< the hidden row that is 1 once the plant has touched the ground
  std::optional<Cascade> cascade;      ///< of a controller that is known to work, if one is
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

inline constexpr double kSecondsPerSubstep = 8e-9;  ///< of a plant's physics, on one core

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

/// Every plant there is, in the order of plants/list.inc.
const Catalog<Plant>& plants();

}  // namespace gust
