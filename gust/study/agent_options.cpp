#include "gust/study/agent_options.h"

#include <unistd.h>

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

void check_memory(std::uint64_t needed, std::uint64_t available, const Place& place) {
  if (needed <= available) return;
  throw error_at(place, "the agent's 'buffer' would take ", needed,
                 " bytes of memory when it is full, and the machine has ", available, "; use a smaller one");
}

Made<Agent> make_agent(const Table& agent, const Setup& setup) {
  Made<Agent> made = agents().make(resolve_agent(agent, setup));
  const auto pages = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES));
  check_memory(made->memory(setup.plant->spec()), pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE)),
               agent.place);
  return made;
}

}  // namespace gust
