#pragma once

#include <memory>

#include "gust/control/policy.h"
#include "gust/nn/onnx.h"

namespace gust {

/// The policy of a network whose inputs are the observation and whose outputs are the action. Observations are rounded
/// to float32, as networks are trained; the action is what comes out, not clipped. A NaN goes in and comes out.
std::unique_ptr<Policy> network_policy(OnnxModel model);

}  // namespace gust
