#pragma once

#include "gust/sim/randomise.h"
#include "gust/study/setup.h"

namespace gust {

/// The full options of an agent: those of its "profile" (the setup's preset if it names none), then its own.
Table resolve_agent(const Table& agent, const Setup& setup);

/// "randomise": the name of a range of the setup's preset (low, mid, high), or a table as read_randomisation takes it.
Randomisation parse_randomise(const Value& value, const Setup& setup);

}  // namespace gust
