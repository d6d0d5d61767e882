#include "gust/setup/setup.h"

#include <algorithm>
#include <iterator>

#include "gust/setup/presets.h"

namespace gust {
namespace {

bool has_field(const Entry<Plant>& entry, std::string_view name) {
  return std::ranges::any_of(entry.fields, [&](const FieldInfo& field) { return field.name == name; });
}

/// A mistake in the user's own keys, told before they are mixed with the preset's.
void check_options(const Table& plant, const Entry<Plant>& entry) {
  std::vector<std::string> known = {"kind", "preset"};
  for (const FieldInfo& field : entry.fields) known.push_back(field.name);
  check_keys(plant, known, cat("the plant ", entry.name));
}

/// Where the user himself has said where a force pulls.
struct TapPoints {
  const Value* of_plant = nullptr;
  const Value* of_readings = nullptr;
};

Readings read_readings(const Preset& preset, std::string_view kind, const Table* own) {
  Readings readings;
  read_fields(readings, preset_part(preset, kind, "readings"), cat("the readings of ", preset.name));
  if (own != nullptr) read_fields(readings, *own, "readings");
  return readings;
}

/// The tap point is a reading and an option of a plant that has the choice: one value for both.
void agree_on_tap_point(Table& options, const Entry<Plant>& entry, Readings& readings, const TapPoints& own) {
  if (own.of_plant != nullptr && own.of_readings == nullptr) {
    read_value(readings.tap_point, *own.of_plant, "tap_point", one_of("com|tip"));
  }
  if (own.of_plant != nullptr && own.of_plant->as_text("tap_point") != readings.tap_point) {
    throw error_at(own.of_plant->place, "'tap_point' is '", own.of_plant->as_text("tap_point"), "' here and '",
                   readings.tap_point, "' among the readings; say it once");
  }
  if (has_field(entry, "tap_point")) return options.set("tap_point", {readings.tap_point, options.place});
  if (readings.tap_point == Readings{}.tap_point) return;
  throw error_at(own.of_readings ? own.of_readings->place : options.place, "'tap_point' means nothing to the plant ",
                 entry.name, ", which has no choice");
}

/// A mistake in the kind is told before all else, with the nearest of all kinds.
[[noreturn]] void unknown_kind(std::string_view kind, const Place& place) {
  throw error_at(place, "unknown plant '", kind, "'", did_you_mean(kind, plant_kinds()), " (gust list plants)");
}

template <class T>
const Entry<T>* find_entry(const Catalog<T>& catalog, std::string_view kind) {
  const auto at = std::ranges::find(catalog.entries(), kind, &Entry<T>::name);
  return at == catalog.entries().end() ? nullptr : &*at;
}

/// What is no plant with equations of motion: its options are its own.
Setup other_setup(const Entry<LoopSource>& entry, const Table& plant, const Table* readings) {
  if (readings != nullptr && !readings->items.empty())
    throw error_at(readings->items.front().second.place, "readings are for plants with equations of motion; '",
                   entry.name, "' is none");
  Setup setup;
  setup.plant = entry.make(plant);
  return setup;
}

Setup plant_setup(const Entry<Plant>& entry, const Table& plant, const Table* readings) {
  const Value* named = plant.find("preset");
  const Preset& preset = named ? preset_at(named->as_text("preset"), entry.name, named->place)
                               : preset_at(kStandardPreset, entry.name, plant.place);
  check_options(plant, entry);

  Table options = preset_part(preset, entry.name, "plant");
  for (const auto& [key, value] : plant.items) {
    if (key != "preset") options.set(key, value);
  }
  options.place = plant.place;
  Setup setup;
  setup.readings = read_readings(preset, entry.name, readings);
  setup.preset = preset.name;
  agree_on_tap_point(options, entry, setup.readings,
                     {plant.find("tap_point"), readings ? readings->find("tap_point") : nullptr});
  Made<Plant> made = entry.make(options);
  setup.plant = {std::make_shared<PlantLoops>(made.object, setup.readings), made.kind, made.options};
  return setup;
}

}  // namespace

const Plant& Setup::equations(std::string_view what, const Place& place) const {
  if (const Plant* equations = plant->plant()) return *equations;
  throw error_at(place, what, " needs the equations of motion of a plant, and '", plant.kind,
                 "' has none; choose a policy that acts on observations alone");
}

std::string Setup::readings_text() const { return preset.empty() ? std::string() : canonical_fields(readings); }

std::string Setup::canonical() const {
  if (preset.empty()) return cat("plant ", plant.canonical(), "\n");
  return cat("preset ", preset, "\nplant ", plant.canonical(), "\nreadings ", readings_text(), "\n");
}

void set_preset(Table& plant, const std::string& preset, const Place& place) {
  const bool has_presets = !preset_names(plant.find("kind")->as_text("kind")).empty();
  if (has_presets || preset != kStandardPreset) plant.set("preset", {preset, place});
}

std::vector<std::string> plant_kinds() {
  std::vector<std::string> kinds = plants().names();
  std::ranges::copy(loop_sources().names(), std::back_inserter(kinds));
  return kinds;
}

const std::vector<FieldInfo>& plant_fields(std::string_view kind, const Place& place) {
  if (const Entry<Plant>* entry = find_entry(plants(), kind)) return entry->fields;
  if (const Entry<LoopSource>* entry = find_entry(loop_sources(), kind)) return entry->fields;
  unknown_kind(kind, place);
}

Setup make_setup(const Table& plant, const Table* readings) {
  const Value* kind = plant.find("kind");
  if (kind == nullptr) throw error_at(plant.place, "a plant needs a 'kind': ", join(plant_kinds(), ", "));
  const std::string& name = kind->as_text("kind");
  if (const Entry<Plant>* entry = find_entry(plants(), name)) return plant_setup(*entry, plant, readings);
  if (const Entry<LoopSource>* entry = find_entry(loop_sources(), name)) return other_setup(*entry, plant, readings);
  unknown_kind(name, kind->place);
}

}  // namespace gust
