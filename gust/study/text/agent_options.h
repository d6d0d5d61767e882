#pragma once

#include "gust/agents/agent.h"
#include "gust/setup/setup.h"
#include "gust/sim/randomise.h"

namespace gust {

/// The full options of an agent: those of its "profile" (the setup's preset if it names none), then its own.
Table resolve_agent(const Table& agent, const Setup& setup);

/// The agent of a table, with these options. An Error that says the numbers if its memory does not fit the machine's.
Made<Agent> make_agent(const Table& agent, const Setup& setup);

/// The check alone, for a machine that has so many bytes.
void check_memory(std::uint64_t needed, std::uint64_t available, const Place& place);

/// "randomise": the name of a range of the setup's preset (low, mid, high), or a table as read_randomisation takes it.
Randomisation parse_randomise(const Value& value, const Setup& setup);

/// "curve": "training" where learning curves are measured on the task of the training, with its draws and disturbances;
/// "nominal" where they are not.
bool parse_curve(const Value& value);

}  // namespace gust
