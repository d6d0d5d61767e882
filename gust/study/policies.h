#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "gust/control/network_policy.h"
#include "gust/study/setup.h"

namespace gust {

/// The policies that need no file: lqr (weights of the plant's reward), zero, pd. An Error at the place for a name that
/// is none, and for a plant that has no such policy.
std::unique_ptr<Policy> make_policy(std::string_view kind, const Setup& setup, const Place& place = {"gust"});

/// How a file's policy is used.
struct PolicyUse {
  Arithmetic arithmetic = Arithmetic::kDouble;
  std::optional<double> alpha = {};  ///< the risk level to act at; the file's own if none
  std::string output = {};           ///< the output of the file that is the action; empty: read_onnx finds it
  const OnnxData* data = nullptr;    ///< the files beside it that hold its weights, if any do
};

/// The policy of an ONNX file. An Error that starts with `name` if the bytes are no policy, if inputs or outputs do not
/// fit the plant (mean and log-deviation joined to one output are named as such), if it takes no risk level and one is
/// asked for, or if the metadata gust.plant, gust.preset or gust.units say that it was made for something else.
std::unique_ptr<Policy> onnx_policy(std::string_view bytes, std::string_view name, const Setup& setup,
                                    const PolicyUse& use = {});

}  // namespace gust
