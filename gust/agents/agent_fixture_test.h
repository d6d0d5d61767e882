#pragma once

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "gust/agents/agent.h"

namespace gust {

using Options = std::vector<std::pair<std::string, Value>>;

inline Value number(double value) { return {value, {"test"}}; }
inline Value integer(std::int64_t value) { return {value, {"test"}}; }
inline Value text(const char* value) { return {std::string(value), {"test"}}; }

inline Made<Plant> cartpole() { return plants().make({{{"kind", text("cartpole")}}, {"test"}}); }

}  // namespace gust
