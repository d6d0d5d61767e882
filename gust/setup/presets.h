#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gust/core/value.h"

namespace gust {

/// A published set of options: studies/presets/NAME.toml, compiled into the program.
///
/// Its table has [KIND.plant], [KIND.readings], [KIND.agent.AGENT] and [KIND.randomise.RANGE] for each kind of plant
/// that it knows, and [agent.AGENT] for what an agent does on any plant. A key "like" names an agent whose options come
/// first. One without plants is a profile of agents only.
struct Preset {
  std::string name;
  std::string summary;
  Table table;

  bool has_plant(std::string_view kind) const;
};

/// All of them, in the order of preference.
const std::vector<Preset>& presets();

/// The names of those that know a kind of plant.
std::vector<std::string> preset_names(std::string_view plant);

/// The preset of a plant; an Error at the place if there is none, with the nearest name.
const Preset& preset_at(std::string_view name, std::string_view plant, const Place& place = {"gust"});

/// What a preset says about a plant's "plant", "readings" or "randomise"; an empty table if nothing.
Table preset_part(const Preset& preset, std::string_view plant, std::string_view part);

/// Whether the preset says anything about an agent on this plant or on any.
bool has_agent_profile(const Preset& preset, std::string_view agent, std::string_view plant);

/// The options of an agent under a profile: those for any plant, then those for this one. An Error at the place if
/// there is no such profile, or none for the agent.
Table agent_profile(std::string_view agent, std::string_view plant, std::string_view profile,
                    const Place& place = {"gust"});

}  // namespace gust
