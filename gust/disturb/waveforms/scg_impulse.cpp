#include <cmath>

#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

/// safe-control-gym's impulse: an even duration disturbs one step less than it says and starts one late.
struct ScgImpulse {
  std::int64_t offset = 2;
  std::int64_t duration = 2;
  double decay = 1.0;

  static constexpr std::tuple kFields = {
      field("offset", &ScgImpulse::offset, "step offset as safe-control-gym counts it", non_negative, "control steps"),
      field("duration", &ScgImpulse::duration, "nominal width", at_least(1), "control steps"),
      field("decay", &ScgImpulse::decay, "factor per control step of distance to the peak", between(0, 1)),
  };

  void fill(std::span<double> out, double, Rng) const {
    const double half = static_cast<double>(duration) / 2.0;
    const double peak = std::floor(static_cast<double>(offset) + half);
    for (std::size_t k = 0; k < out.size(); ++k) {
      const double distance = std::abs(static_cast<double>(k) - peak);
      const bool on = static_cast<std::int64_t>(k) >= offset && distance < half;
      out[k] = on ? power(decay, distance) : 0.0;
    }
  }
};

}  // namespace

Entry<Waveform> waveform_scg_impulse() {
  return waveform_entry<ScgImpulse>("scg_impulse", "The impulse as safe-control-gym has it, for comparison.",
                                    "safe-control-gym, disturbances.py; docs/disturbances.md 3.2");
}

}  // namespace gust
