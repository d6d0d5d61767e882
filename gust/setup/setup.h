#pragma once

#include <string>

#include "gust/control/readings.h"
#include "gust/sim/plant.h"

namespace gust {

/// What every episode shares: the plant and how the open questions about the loop are answered.
struct Setup {
  Made<Plant> plant;
  Readings readings;
  std::string preset;
};

inline constexpr std::string_view kStandardPreset = "scg-2022";

/// The setup of a study's `plant` table: its "kind", its "preset" (scg-2022 if it names none) and options of the plant
/// that replace the preset's. `readings` replaces those of the preset. The tap point is a reading; it is handed to a
/// plant that has the choice. Unknown keys and impossible values are Errors with their place.
Setup make_setup(const Table& plant, const Table* readings = nullptr);

}  // namespace gust
