#include "gust/study/agent_options.h"

#include "gust/study/presets.h"

namespace gust {

Table resolve_agent(const Table& agent, const Setup& setup) {
  const Value* kind = agent.find("kind");
  if (kind == nullptr) throw error_at(agent.place, "an agent needs a 'kind' (gust list agents)");
  const Value* profile = agent.find("profile");
  const std::string& name = profile ? profile->as_text("profile") : setup.preset;
  Table options = agent_profile(kind->as_text("kind"), setup.plant.kind, name, profile ? profile->place : agent.place);
  for (const auto& [key, value] : agent.items) options.set(key, value);
  options.erase("profile");
  options.place = agent.place;
  return options;
}

}  // namespace gust
