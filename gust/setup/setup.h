#pragma once

#include <string>

#include "gust/control/plant_loops.h"

namespace gust {

/// What every episode shares: the plant, or whatever takes its place, and how the open questions about its loop are
/// answered.
struct Setup {
  Made<LoopSource> plant;
  Readings readings;   ///< of a plant with equations of motion; else the standard ones, which mean nothing
  std::string preset;  ///< empty for what is no such plant

  /// The equations of motion; an Error at the place if there are none, for `what` cannot do without.
  const Plant& equations(std::string_view what, const Place& place) const;
  /// All that makes the loops: preset, plant and readings, a line each.
  std::string canonical() const;
  std::string readings_text() const;  ///< empty where there are none
};

inline constexpr std::string_view kStandardPreset = "scg-2022";

/// The setup of a study's `plant` table: its "kind", its "preset" (scg-2022 if it names none) and options of the plant
/// that replace the preset's. `readings` replaces those of the preset. The tap point is a reading; it is handed to a
/// plant that has the choice. A kind of loop_sources() has options of its own, and neither preset nor readings. Unknown
/// keys and impossible values are Errors with their place.
Setup make_setup(const Table& plant, const Table* readings = nullptr);

/// Puts a preset that was chosen beside the kind into a plant's table; the standard one only where the kind has
/// presets.
void set_preset(Table& plant, const std::string& preset, const Place& place);

/// Every kind of plant that a study may have, plants with equations of motion first.
std::vector<std::string> plant_kinds();
/// The options of a kind; an unknown one is an Error at the place, with the nearest name.
const std::vector<FieldInfo>& plant_fields(std::string_view kind, const Place& place);

}  // namespace gust
