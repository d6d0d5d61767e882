#include "gust/study/text/agent_options.h"

#include <unistd.h>

#include "gust/core/fields.h"
#include "gust/setup/presets.h"

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
  check_memory(made->memory(setup.equations("a training", agent.place).spec()),
               pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE)), agent.place);
  return made;
}

Randomisation parse_randomise(const Value& value, const Setup& setup) {
  const Interface& spec = setup.plant->spec();
  const auto* name = std::get_if<std::string>(&value.data);
  if (name == nullptr) return read_randomisation(value.as_table("randomise"), spec);
  const Table ranges = preset_part(preset_at(setup.preset, setup.plant.kind), setup.plant.kind, "randomise");
  const Value* range = ranges.find(*name);
  if (range == nullptr) {
    const std::vector<std::string> names = ranges.keys();
    throw error_at(value.place, "unknown range '", *name, "' of parameters", did_you_mean(*name, names),
                   names.empty() ? cat("; ", setup.preset, " names none for ", setup.plant.kind)
                                 : cat("; ", setup.preset, " names ", join(names, ", "), " for ", setup.plant.kind),
                   "; or spell it out as a table");
  }
  Randomisation randomisation = read_randomisation(range->as_table(*name), spec);
  randomisation.name = *name;
  return randomisation;
}

bool parse_curve(const Value& value) {
  std::string word;
  read_value(word, value, "curve", one_of("nominal|training"));
  return word == "training";
}

}  // namespace gust
