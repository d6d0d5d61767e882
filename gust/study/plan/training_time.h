#pragma once

#include "gust/agents/agent.h"
#include "gust/control/loop_source.h"

namespace gust {

/// What a training takes on one core, guessed without having measured anything.
double training_seconds(const Agent& agent, const LoopSource& source);

}  // namespace gust
