#include "gust/setup/setup.h"

#include <algorithm>

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

}  // namespace

Setup make_setup(const Table& plant, const Table* readings) {
  const Value* kind = plant.find("kind");
  if (kind == nullptr) throw error_at(plant.place, "a plant needs a 'kind': ", join(plants().names(), ", "));
  const Entry<Plant>& entry = plants().at(kind->as_text("kind"), kind->place);
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
  setup.plant = entry.make(options);
  return setup;
}

}  // namespace gust
