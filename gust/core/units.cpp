#include "gust/core/units.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include "gust/core/text.h"

namespace gust {
namespace {

struct KnownUnit {
  const char* name;
  const char* si;
  double in_si;  // one of `si` is so many of it
};

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kTurns = 0.5 / std::numbers::pi;
constexpr double kFoot = 0.3048;            // m, exactly
constexpr double kPound = 4.4482216152605;  // N, exactly
constexpr double kGram = 9.80665e-3;        // N that weigh one gram, exactly

constexpr KnownUnit kUnits[] = {
    {"m", "m", 1},
    {"cm", "m", 100},
    {"mm", "m", 1000},
    {"km", "m", 1e-3},
    {"in", "m", 12 / kFoot},
    {"ft", "m", 1 / kFoot},
    {"m/s", "m/s", 1},
    {"cm/s", "m/s", 100},
    {"mm/s", "m/s", 1000},
    {"km/h", "m/s", 3.6},
    {"in/s", "m/s", 12 / kFoot},
    {"ft/s", "m/s", 1 / kFoot},
    {"rad", "rad", 1},
    {"mrad", "rad", 1000},
    {"deg", "rad", kDegrees},
    {"turn", "rad", kTurns},
    {"rad/s", "rad/s", 1},
    {"mrad/s", "rad/s", 1000},
    {"deg/s", "rad/s", kDegrees},
    {"turn/s", "rad/s", kTurns},
    {"rpm", "rad/s", 60 * kTurns},
    {"N", "N", 1},
    {"mN", "N", 1000},
    {"kN", "N", 1e-3},
    {"gf", "N", 1 / kGram},
    {"lbf", "N", 1 / kPound},
};

}  // namespace

double units_in(const std::string& unit, const std::string& si, const std::string& what, const Place& place) {
  std::vector<std::string> names;
  for (const KnownUnit& known : kUnits) {
    if (si != known.si) continue;
    if (unit == known.name) return known.in_si;
    names.emplace_back(known.name);
  }
  if (names.empty()) names.push_back(si);
  throw error_at(place, "'", unit, "' is no unit of ", what, " [", si, "]", did_you_mean(unit, names), "; units are ",
                 join(names, ", "));
}

}  // namespace gust
