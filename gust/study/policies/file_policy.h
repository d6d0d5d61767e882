#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "gust/control/policy_interface.h"
#include "gust/setup/setup.h"
#include "gust/study/policies/network_policy.h"

namespace gust {

/// Risk levels that a policy may be told to act at.
inline constexpr Range kLevels{.low = 0, .high = 1, .low_open = true};

/// "alpha 0.1\n", a part of canonical text: the risk level to act at; empty if it is the policy's own.
std::string level_text(const std::optional<double>& alpha);

/// The cascade that the plant says to be known to work; an Error at the place if it says none.
std::unique_ptr<Policy> pd_policy(const Setup& setup, const Place& place);

/// How a file's policy is used.
struct PolicyUse {
  Arithmetic arithmetic = Arithmetic::kDouble;
  std::optional<double> alpha = {};  ///< the risk level to act at; the file's own if none
  std::string output = {};           ///< the output of the file that is the action; empty: read_onnx finds it
  const OnnxData* data = nullptr;    ///< the files beside it that hold its weights, if any do
  PolicyInterface interface = {};    ///< how it sees and acts, if not as gust does
};

/// A policy from a file, and what the file leaves open.
struct FilePolicy {
  std::unique_ptr<Policy> policy;
  bool foreign = false;           ///< its metadata have no gust.plant
  std::string unit_warning = {};  ///< if nobody says in which unit it acts and the preset's actions are normalised
};

/// The policy of an ONNX file. An Error that starts with `name` if the bytes are no policy, if inputs or outputs do not
/// fit the plant or the interface (mean and log-deviation joined to one output are named as such), if it takes no risk
/// level and one is asked for, or if the metadata gust.plant, gust.preset or gust.units say that it was made for
/// something else.
FilePolicy file_policy(std::string_view bytes, std::string_view name, const Setup& setup, const PolicyUse& use = {});
std::unique_ptr<Policy> onnx_policy(std::string_view bytes, std::string_view name, const Setup& setup,
                                    const PolicyUse& use = {});

/// Where to look when a foreign policy fails at once: what gust gives and takes, and how to say otherwise.
std::string interface_hint(const Interface& spec);

}  // namespace gust
