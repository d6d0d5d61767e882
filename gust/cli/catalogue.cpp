#include "gust/cli/catalogue.h"

#include "gust/agents/agent.h"
#include "gust/cli/command.h"
#include "gust/core/text.h"
#include "gust/disturb/injection.h"
#include "gust/eval/metric.h"
#include "gust/setup/preset_files.h"
#include "gust/setup/presets.h"
#include "gust/setup/setup.h"
#include "gust/sim/distribution.h"
#include "gust/study/policies/policy_source.h"

namespace gust {
namespace {

std::string components_text(const std::vector<Component>& components) {
  std::vector<std::string> parts;
  for (const Component& component : components) parts.push_back(cat(component.name, " [", component.unit, "]"));
  return join(parts, ", ");
}

/// { kind = "sine", frequency = 1, phase = 0 }: all options that have a default worth showing.
std::string inline_table(const std::string& name, const std::vector<FieldInfo>& fields) {
  std::string text = cat("{ kind = \"", name, "\"");
  for (const FieldInfo& field : fields) text += cat(", ", field.name, " = ", field.standard);
  return text + " }";
}

template <class T>
CatalogueItem item_of(const Entry<T>& entry) {
  return {entry.name, entry.summary, entry.source, entry.fields, {}, {}, {}};
}

std::string parameters_text(const Interface& spec) {
  std::vector<std::string> parameters;
  for (const Parameter& parameter : spec.parameters)
    parameters.push_back(cat(parameter.name, " = ", parameter.nominal, " [", parameter.unit, "]"));
  return join(parameters, ", ");
}

/// What has no equations of motion, but can be reset and stepped.
CatalogueItem loop_item(const Entry<LoopSource>& entry) {
  const Made<LoopSource> made = entry.make(Table{});
  const Interface& spec = made->spec();
  CatalogueItem item = item_of(entry);
  item.notes = {{spec.state.empty() ? "observation" : "state", components_text(spec.measured())},
                {"action", components_text(spec.action)}};
  if (!spec.force.empty()) item.notes.emplace_back("force at the dynamics site", components_text(spec.force));
  if (!spec.parameters.empty()) item.notes.emplace_back("parameters that a study may vary", parameters_text(spec));
  const std::string missing = MetricSet(spec).not_applicable();
  if (!missing.empty()) item.notes.emplace_back("metrics that are not applicable", missing);
  item.example = cat("plant = ", inline_table(entry.name, entry.fields));
  return item;
}

CatalogueKind plant_kind() {
  CatalogueKind kind{"plant", "plants", {}};
  for (const Entry<Plant>& entry : plants().entries()) {
    const Made<Plant> made = entry.make(Table{});
    const PlantSpec& spec = made->spec();
    CatalogueItem item = item_of(entry);
    item.notes = {{"state", components_text(spec.state)},
                  {"action", components_text(spec.action)},
                  {"force at the dynamics site", components_text(spec.force)},
                  {"parameters that a study may vary", parameters_text(spec)},
                  {"presets", join(preset_names(entry.name), ", ")}};
    const Table ranges = preset_part(preset_at(kStandardPreset, entry.name), entry.name, "randomise");
    if (!ranges.items.empty()) item.notes.emplace_back("ranges for randomise", join(ranges.keys(), ", "));
    item.example = cat("plant = { kind = \"", entry.name, "\", preset = \"", kStandardPreset, "\", ",
                       spec.parameters.front().name, " = ", spec.parameters.front().nominal, " }");
    kind.items.push_back(std::move(item));
  }
  for (const Entry<LoopSource>& entry : loop_sources().entries()) kind.items.push_back(loop_item(entry));
  return kind;
}

CatalogueKind waveform_kind() {
  CatalogueKind kind{"waveform", "waveforms", {}};
  for (const Entry<Waveform>& entry : waveforms().entries()) {
    CatalogueItem item = item_of(entry);
    const Made<Waveform> made = entry.make(Table{});
    item.notes = {{"random", made->random() ? "yes; every channel has its own stream" : "no; all channels in phase"}};
    if (!made->scales())
      item.notes.emplace_back("level", "part of the shape, not its factor; the shape goes on from episode to episode");
    item.example = cat("[[sweep]]\nname     = \"action ", entry.name,
                       "\"\nsite     = \"action\"\nwaveform = ", inline_table(entry.name, entry.fields),
                       "\nlevels   = { from = 0, to = 10, count = 11 }");
    kind.items.push_back(std::move(item));
  }
  return kind;
}

CatalogueKind effect_kind() {
  CatalogueKind kind{"effect", "effects", {}};
  for (const Entry<Effect>& entry : effects().entries()) {
    CatalogueItem item = item_of(entry);
    const Made<Effect> made = entry.make(Table{});
    item.notes = {{"level", cat("in ", made->unit(), ", from 0, which changes no bit")},
                  {"random", made->random() ? "yes; every channel has its own stream" : "no"}};
    item.example = cat("[[sweep]]\nname   = \"action ", entry.name,
                       "\"\nsite   = \"action\"\neffect = ", inline_table(entry.name, entry.fields),
                       "\nlevels = [0, 0.01, 0.02, 0.04, 0.08]");
    kind.items.push_back(std::move(item));
  }
  return kind;
}

std::string policy_example(std::string_view agent, std::string_view profile) {
  return cat("[[policy]]\nname  = \"", agent, "\"\nkind  = \"train\"\nagent = { kind = \"", agent, "\", profile = \"",
             profile, "\", steps = 1_000_000 }\nseeds = [1, 2, 3]");
}

/// The first agent that a preset has a profile of.
std::string agent_of(const Preset& preset) {
  for (const std::string& agent : agents().names()) {
    for (const std::string& plant : plants().names())
      if (has_agent_profile(preset, agent, plant)) return agent;
  }
  throw Bug(cat("the preset ", preset.name, " is of no use"));
}

CatalogueKind policy_sources() {
  CatalogueKind kind{"policy", "policies", {}};
  for (const PolicyKind& entry : policy_kinds())
    kind.items.push_back({entry.name, entry.summary, entry.source, entry.fields, {}, {}, entry.example});
  return kind;
}

CatalogueKind agent_kind() {
  CatalogueKind kind{"agent", "agents", {}};
  for (const Entry<Agent>& entry : agents().entries()) {
    CatalogueItem item = item_of(entry);
    std::vector<std::string> profiles;
    for (const Preset& preset : presets()) {
      for (const Entry<Plant>& plant : plants().entries()) {
        if (!has_agent_profile(preset, entry.name, plant.name)) continue;
        profiles.push_back(preset.name);
        break;
      }
    }
    item.notes = {
        {"profiles", join(profiles, ", ")},
        {"on any plant and in any agent", "disturb = [ … ] and randomise = \"mid\" or { … }, on in training"}};
    item.example = policy_example(entry.name, kStandardPreset);
    kind.items.push_back(std::move(item));
  }
  return kind;
}

CatalogueKind distribution_kind() {
  CatalogueKind kind{"distribution", "distributions", {}};
  for (const Entry<Distribution>& entry : distributions().entries()) {
    CatalogueItem item = item_of(entry);
    item.notes = {{"in a study", "every option is given: no default is assumed"}};
    item.example =
        cat("[[policy]]\nname  = \"ppo-dr\"\nkind  = \"train\"\nagent = { kind = \"ppo\", randomise = { pole_length = ",
            inline_table(entry.name, entry.fields), " } }");
    kind.items.push_back(std::move(item));
  }
  return kind;
}

CatalogueKind metric_kind() {
  CatalogueKind kind{"metric", "metrics", {}};
  for (const Entry<Metric>& entry : metrics().entries()) {
    CatalogueItem item = item_of(entry);
    const Made<Metric> made = entry.make(Table{});
    item.notes = {{"better", made->traits().higher_is_better ? "higher" : "lower"}};
    if (!made->traits().unit.empty()) item.notes.emplace_back("unit", std::string(made->traits().unit));
    item.example = cat("[evaluate]\nmetrics = [\"", entry.name, "\"]");
    kind.items.push_back(std::move(item));
  }
  return kind;
}

CatalogueKind preset_kind() {
  CatalogueKind kind{"preset", "presets", {}};
  for (const Preset& preset : presets()) {
    std::vector<std::string> of;
    for (const Entry<Plant>& plant : plants().entries()) {
      if (preset.has_plant(plant.name)) of.push_back(plant.name);
    }
    CatalogueItem item{preset.name, preset.summary, {}, {}, {}, {}, {}};
    item.notes = {{"plants", of.empty() ? "none; a profile of agents" : join(of, ", ")}};
    item.text = preset_file(preset.name);
    item.example = of.empty() ? policy_example(agent_of(preset), preset.name)
                              : cat("plant = { kind = \"", of.front(), "\", preset = \"", preset.name, "\" }");
    kind.items.push_back(std::move(item));
  }
  return kind;
}

CatalogueKind site_kind() {
  static constexpr const char* kSummaries[] = {
      "What the policy sees: added to the state that it observes.",
      "What the policy does: added to its action, in physical units, before the actuator saturates.",
      "What pulls at the plant: a force, drawn once a control step and held over its physics steps."};
  CatalogueKind kind{"site", "sites", {}};
  for (const Site site : kSites) {
    CatalogueItem item{
        std::string(site_name(site)), kSummaries[static_cast<int>(site)], "docs/disturbances.md 1", {}, {}, {}, {}};
    std::string channel;
    const auto add_channels = [&](const std::string& plant, const Interface& spec) {
      const std::vector<Component>& channels = channels_of(site, spec);
      if (channels.empty()) return;
      item.notes.emplace_back(cat("channels of ", plant), components_text(channels));
      if (channel.empty()) channel = channels.front().name;
    };
    for (const Entry<Plant>& plant : plants().entries()) add_channels(plant.name, plant.make(Table{})->spec());
    for (const Entry<LoopSource>& other : loop_sources().entries())
      add_channels(other.name, other.make(Table{})->spec());
    item.example = cat("[[sweep]]\nname     = \"", item.name, " step\"\nsite     = \"", item.name, "\"\nchannels = [\"",
                       channel, "\"]\nwaveform = { kind = \"step\", offset = 2 }\n", "levels   = [0, 0.1, 0.2]");
    kind.items.push_back(std::move(item));
  }
  return kind;
}

CatalogueKind command_kind(const CLI::App& program) {
  CatalogueKind kind{"command", "commands", {}};
  for (const std::string& name : command_names(program)) {
    const CLI::App& command = find_command(program, {name});
    std::string first = command.get_description();
    first.resize(std::min(first.find('\n'), first.size()));
    CatalogueItem item{name, first, {}, {}, {}, {}, {}};
    item.text = command.help("gust");
    kind.items.push_back(std::move(item));
  }
  return kind;
}

}  // namespace

std::vector<CatalogueKind> catalogue(const CLI::App& program) {
  return {plant_kind(),        policy_sources(), waveform_kind(), effect_kind(), agent_kind(),
          distribution_kind(), metric_kind(),    preset_kind(),   site_kind(),   command_kind(program)};
}

const CatalogueKind& find_kind(const std::vector<CatalogueKind>& kinds, std::string_view name) {
  std::vector<std::string> names;
  for (const CatalogueKind& kind : kinds) {
    if (kind.name == name || kind.plural == name) return kind;
    names.push_back(kind.plural);
  }
  throw Error(cat("unknown kind '", name, "'", did_you_mean(name, names), "; kinds are ", join(names, ", ")));
}

const CatalogueItem& find_item(const CatalogueKind& kind, std::string_view name) {
  std::vector<std::string> names;
  for (const CatalogueItem& item : kind.items) {
    if (item.name == name) return item;
    names.push_back(item.name);
  }
  throw Error(cat("unknown ", kind.name, " '", name, "'", did_you_mean(name, names), " (gust list ", kind.plural, ")"));
}

}  // namespace gust
