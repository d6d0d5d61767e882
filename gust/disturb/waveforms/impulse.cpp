#include <cmath>

#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

struct Impulse {
  std::int64_t offset = 2;
  std::int64_t duration = 2;
  double decay = 1.0;

  static constexpr std::tuple kFields = {
      field("offset", &Impulse::offset, "first control step that is disturbed", non_negative, "control steps"),
      field("duration", &Impulse::duration, "how many control steps are disturbed", at_least(1), "control steps"),
      field("decay", &Impulse::decay, "factor per control step of distance to the middle", between(0, 1)),
  };

  void fill(std::span<double> out, double, Rng) const {
    const double middle = static_cast<double>(offset) + (static_cast<double>(duration) - 1.0) / 2.0;
    for (std::size_t k = 0; k < out.size(); ++k) {
      const auto step = static_cast<std::int64_t>(k);
      const bool on = step >= offset && step - offset < duration;
      out[k] = on ? power(decay, std::abs(static_cast<double>(step) - middle)) : 0.0;
    }
  }
};

}  // namespace

Entry<Waveform> waveform_impulse() {
  return waveform_entry<Impulse>("impulse", "The level during `duration` control steps from `offset`, else zero.",
                                 "Glossop et al. 2022, fig. 2c (width two, two steps in); docs/disturbances.md 3.1");
}

}  // namespace gust
