#include <cmath>

#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

struct Triangle {
  double frequency = 1.0;
  double phase = 0.0;
  std::string polarity = "bipolar";

  static constexpr std::tuple kFields = {
      field("frequency", &Triangle::frequency, "periods per second", positive, "Hz"),
      field("phase", &Triangle::phase, "start within a period", anything, "periods"),
      field("polarity", &Triangle::polarity, "between -1 and 1, or between 0 and 1", one_of("bipolar|unipolar")),
  };

  void fill(std::span<double> out, double rate, Rng) const {
    const bool bipolar = polarity == "bipolar";
    for (std::size_t k = 0; k < out.size(); ++k) {
      const double p = phase_at(k, frequency, rate, phase);
      out[k] = bipolar ? 1.0 - 4.0 * std::abs(p - 0.5) : 1.0 - 2.0 * std::abs(p - 0.5);
    }
  }
};

}  // namespace

Entry<Waveform> waveform_triangle() {
  return waveform_entry<Triangle>("triangle", "Rises linearly from the bottom to the level and falls at the same rate.",
                                  "Glossop et al. 2022, fig. 2e; docs/disturbances.md 3.1");
}

}  // namespace gust
