#pragma once

#include "gust/control/policy.h"
#include "gust/sim/plant.h"

namespace gust {

/// A cascade of proportional-derivative loops about the reference that the next step is judged by, in the policy's
/// action unit: the reference simulator's "pd" controller.
std::unique_ptr<Policy> cascade_policy(const Plant& plant, const Cascade& cascade);

}  // namespace gust
