#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gust/control/policy.h"
#include "gust/sim/interface.h"

namespace gust {

/// One number that a foreign policy sees: scale * f(component) + offset, where the component is gust's, in SI units,
/// and f is the identity, the sine or the cosine.
struct ObservedNumber {
  enum class Form { kPlain, kSin, kCos };
  std::optional<std::size_t> component;  ///< of the plant's observation; none: the number is the offset, a constant
  Form form = Form::kPlain;
  double scale = 1;
  double offset = 0;

  bool operator==(const ObservedNumber&) const = default;
};

/// What the preset's action is of the policy's: scale * action + offset.
struct GivenNumber {
  double scale = 1;
  double offset = 0;

  bool operator==(const GivenNumber&) const = default;
};

/// How a policy that was made elsewhere sees and acts.
struct PolicyInterface {
  std::vector<ObservedNumber> observe;  ///< in the policy's order; empty: as gust observes
  std::vector<GivenNumber> act;         ///< one per action; empty: as the preset acts
  bool says_unit = false;               ///< whether `act` or `units` was given, be it the preset's own

  /// "observe …\nact …\n" with full precision; empty where nothing differs from gust's own way.
  std::string canonical(const Interface& spec) const;
};

/// What a policy may observe, by name: what is measured, then the references ahead of a plant that shows them ("x_ref",
/// "x_ref2", …).
std::vector<Component> observed_components(const Interface& spec);

/// Reads the keys `observe`, `act` and `units` of a table, those that are there:
///
///   observe = ["theta", "-theta_dot", "cos theta", "x=cm", { x = "cm" }, { theta = 57.3 },
///              { theta = { unit = "deg", scale = -1, offset = 0 } }, 0]
///   act     = { unit = "N", scale = -1, offset = 0 }      # or act = "N"
///   units   = "N"                                         # the same as act = { unit = "N" }
///
/// The unit of an action may be "normalised", or "%": a hundredth of the normalised action or, where the preset acts in
/// physical units, of the actuator's upper bound.
/// The observed number is scale * (component in the unit) + offset; a plain number is a constant. What the policy gives
/// is scaled and offset first, then it is in the unit. Errors with their place.
PolicyInterface read_interface(const Table& table, const Interface& spec);

/// The policy as the plant needs it: it sees what the interface says and its action is translated.
std::unique_ptr<Policy> translated_policy(std::unique_ptr<Policy> policy, const PolicyInterface& interface,
                                          const Interface& spec);

/// The units in which a controller was tuned, by name of state and action.
struct NamedUnits {
  std::vector<double> state;        ///< how many of the unit one SI unit is, state by state
  std::vector<GivenNumber> action;  ///< physical = scale * number + offset, action by action
};

/// Reads `units = { theta = "deg", force = "%" }`, or the one unit of all actions, "N"; what is not named is in SI
/// units. Actions also take "normalised" and "%". Errors with their place.
NamedUnits read_units(const Value* units, const Interface& spec);

/// What gust gives and takes, for people: "x [m], x_dot [m/s], …".
std::string components_text(const std::vector<Component>& components);

}  // namespace gust
