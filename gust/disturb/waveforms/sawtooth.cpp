#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

struct Sawtooth {
  double frequency = 1.0;
  double phase = 0.0;
  std::string polarity = "bipolar";

  static constexpr std::tuple kFields = {
      field("frequency", &Sawtooth::frequency, "periods per second", positive, "Hz"),
      field("phase", &Sawtooth::phase, "start within a period", anything, "periods"),
      field("polarity", &Sawtooth::polarity, "between -1 and 1, or between 0 and 1", one_of("bipolar|unipolar")),
  };

  void fill(std::span<double> out, double rate, Rng) const {
    const bool bipolar = polarity == "bipolar";
    for (std::size_t k = 0; k < out.size(); ++k) {
      const double p = phase_at(k, frequency, rate, phase);
      out[k] = bipolar ? 2.0 * p - 1.0 : p;
    }
  }
};

}  // namespace

Entry<Waveform> waveform_sawtooth() {
  return waveform_entry<Sawtooth>("sawtooth", "Rises linearly from the bottom to the level, then falls back at once.",
                                  "Glossop et al. 2022, fig. 2d; docs/disturbances.md 3.1");
}

}  // namespace gust
