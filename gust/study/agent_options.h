#pragma once

#include "gust/study/setup.h"

namespace gust {

/// The full options of an agent: those of its "profile" (the setup's preset if it names none), then its own.
Table resolve_agent(const Table& agent, const Setup& setup);

}  // namespace gust
