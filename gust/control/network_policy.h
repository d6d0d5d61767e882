#pragma once

#include <memory>

#include "gust/control/policy.h"
#include "gust/nn/mlp.h"

namespace gust {

/// The policy of a network whose inputs are the observation and whose outputs are the action: observations are rounded
/// to float32, as the networks were trained, and the action is what comes out, not clipped.
std::unique_ptr<Policy> network_policy(Mlp<float> network);

}  // namespace gust
