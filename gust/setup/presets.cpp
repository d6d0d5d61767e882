#include "gust/setup/presets.h"

#include <algorithm>

#include "gust/core/text.h"
#include "gust/setup/preset_files.h"
#include "gust/setup/toml.h"

namespace gust {
namespace {

constexpr std::string_view kNames[] = {"scg-2022", "scg-default", "modern", "wcpg", "wcpg-fixed", "raac", "raac-fixed"};
constexpr std::string_view kAgents = "agent";  // the key beside the plants that holds agents for any plant

/// A table inside a table; nullptr if it is not there.
const Table* inner(const Table* table, std::string_view key) {
  const Value* value = table ? table->find(key) : nullptr;
  return value ? &value->as_table(key) : nullptr;
}

Preset read_preset(std::string_view name) {
  Preset preset{std::string(name), {}, parse_toml(preset_file(name), cat("preset ", name))};
  preset.summary = preset.table.find("summary")->as_text("summary");
  preset.table.erase("summary");
  return preset;
}

void replace(Table& options, const Table* by) {
  if (by == nullptr) return;
  for (const auto& [key, value] : by->items) options.set(key, value);
}

/// What a preset says about an agent on any plant, then on this one; first what it says of the agent that it is "like".
void add_profile(Table& options, const Preset& preset, std::string_view agent, std::string_view plant) {
  for (const Table* own :
       {inner(inner(&preset.table, kAgents), agent), inner(inner(inner(&preset.table, plant), kAgents), agent)}) {
    if (own == nullptr) continue;
    if (const Value* like = own->find("like")) add_profile(options, preset, like->as_text("like"), plant);
    replace(options, own);
  }
  options.erase("like");
}

}  // namespace

bool Preset::has_plant(std::string_view kind) const { return kind != kAgents && table.contains(kind); }

const std::vector<Preset>& presets() {
  static const std::vector<Preset> all = [] {
    std::vector<Preset> list;
    for (const std::string_view name : kNames) list.push_back(read_preset(name));
    return list;
  }();
  return all;
}

std::vector<std::string> preset_names(std::string_view plant) {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) {
    if (preset.has_plant(plant)) names.push_back(preset.name);
  }
  return names;
}

const Preset& preset_at(std::string_view name, std::string_view plant, const Place& place) {
  for (const Preset& preset : presets()) {
    if (preset.name == name && preset.has_plant(plant)) return preset;
  }
  const std::vector<std::string> names = preset_names(plant);
  throw error_at(place, "unknown preset '", name, "'", did_you_mean(name, names), "; the presets of ", plant, " are ",
                 join(names, ", "));
}

Table preset_part(const Preset& preset, std::string_view plant, std::string_view part) {
  const Table* found = inner(inner(&preset.table, plant), part);
  return found ? *found : Table{};
}

bool has_agent_profile(const Preset& preset, std::string_view agent, std::string_view plant) {
  return inner(inner(&preset.table, kAgents), agent) || inner(inner(inner(&preset.table, plant), kAgents), agent);
}

Table agent_profile(std::string_view agent, std::string_view plant, std::string_view profile, const Place& place) {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) {
    if (!has_agent_profile(preset, agent, plant)) continue;
    names.push_back(preset.name);
    if (preset.name != profile) continue;
    Table options;
    add_profile(options, preset, agent, plant);
    options.place = place;
    return options;
  }
  throw error_at(place, "unknown profile '", profile, "'", did_you_mean(profile, names), "; the profiles of ", agent,
                 " are ", join(names, ", "));
}

}  // namespace gust
