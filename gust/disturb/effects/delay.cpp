#include <cmath>

#include "gust/core/fields.h"
#include "gust/disturb/effect_entry.h"

namespace gust {
namespace {

/// z(t) = y(t - L), in whole substeps of the plant: L = n control steps and m substeps.
///
///   a signal that acts   z = y(k-n-1) in the first m substeps of control step k, y(k-n) in the others
///   one that is seen     z(k) = y at the time of observation k-n, m substeps earlier
///
/// Before the episode an action is at rest, a force is 0, an observation is the first one (docs/disturbances.md 8).
struct Delay {
  std::string measured_in = "s";

  static constexpr std::tuple kFields = {
      field("unit", &Delay::measured_in, "what levels are measured in: s, or steps, which are control steps",
            one_of("s|steps")),
  };

  std::string_view unit() const { return measured_in; }
  double limit(double rate) const { return measured_in == "s" ? 1.0 : rate; }

  std::int64_t substeps(double level, const EffectPlace& place) const {
    const double steps = measured_in == "s" ? level * place.rate : level;
    const auto most = static_cast<double>(place.steps + 1);  // of which nothing arrives
    return std::llround(std::min(steps, most) * static_cast<double>(place.substeps));
  }
  std::int64_t whole(double level, const EffectPlace& place) const { return substeps(level, place) / place.substeps; }
  std::int64_t split(double level, const EffectPlace& place) const { return substeps(level, place) % place.substeps; }

  /// The last n + 2 values, the newest first.
  std::size_t memory(double level, const EffectPlace& place) const {
    return static_cast<std::size_t>(whole(level, place)) + 2;
  }

  EffectValue apply(EffectValue value, double level, const EffectPlace& place,
                    std::span<double> memory) const noexcept {
    const bool splits = split(level, place) > 0;
    std::copy_backward(memory.begin(), memory.end() - 1, memory.end());
    memory.front() = place.seen && splits ? value.early : value.late;
    const double late = memory[memory.size() - 2];
    return {splits && !place.seen ? memory.back() : late, late};
  }
};

}  // namespace

Entry<Effect> effect_delay() {
  return effect_entry<Delay>("delay",
                             "The signal of a time ago; the level says how long, in whole substeps of the plant.",
                             "Astrom, Wittenmark 1997, Computer-Controlled Systems, 3.2 (docs/disturbances.md 8)");
}

}  // namespace gust
