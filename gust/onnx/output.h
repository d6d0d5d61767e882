#pragma once

#include <onnx/onnx.pb.h>

#include <string_view>

namespace gust {

/// The output of a graph that is the action: the one that is asked for; else 'action' or 'actions', else 'mu', 'mean'
/// or 'deterministic_continuous_actions' (in capitals or not); else the only one that is computed from an input. An
/// Error that starts with `file`, lists the outputs with their shapes and says how to choose one if more than one is
/// left, or none has the name that is asked for.
const onnx::ValueInfoProto& choose_onnx_output(const onnx::GraphProto& graph, std::string_view wanted,
                                               std::string_view file);

}  // namespace gust
