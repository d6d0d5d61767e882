#pragma once

#include <memory>

#include "gust/control/policy.h"
#include "gust/onnx/onnx.h"

namespace gust {

/// How a policy's network is computed. In double nothing is left of the order in which float32 would add up, which a
/// plant on the edge of falling amplifies; float32 is how a network trains, and takes less than half the time.
enum class Arithmetic { kFloat, kDouble };

/// The policy of a network whose inputs are the observation and whose outputs are the action. Observations are rounded
/// to float32, as networks are trained; the action is what comes out, not clipped. A NaN goes in and comes out. What is
/// no plain chain of layers is computed in float32 in any case.
std::unique_ptr<Policy> network_policy(OnnxModel model, Arithmetic arithmetic = Arithmetic::kDouble);

}  // namespace gust
