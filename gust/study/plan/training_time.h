#pragma once

#include "gust/agents/agent.h"

namespace gust {

inline constexpr double kSecondsPerSubstep = 8e-9;  ///< of physics, on one core

/// What a training takes on one core, guessed without having measured anything.
double training_seconds(const Agent& agent, const PlantSpec& spec);

}  // namespace gust
