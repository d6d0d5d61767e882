#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

constexpr double kTurn = 6.283185307179586476925;

struct Sine {
  double frequency = 1.0;
  double phase = 0.0;
  std::string polarity = "bipolar";

  static constexpr std::tuple kFields = {
      field("frequency", &Sine::frequency, "periods per second", positive, "Hz"),
      field("phase", &Sine::phase, "start within a period", anything, "periods"),
      field("polarity", &Sine::polarity, "between -1 and 1, or between 0 and 1", one_of("bipolar|unipolar")),
  };

  void fill(std::span<double> out, double rate, Rng) const {
    const bool bipolar = polarity == "bipolar";
    for (std::size_t k = 0; k < out.size(); ++k) {
      const double p = phase_at(k, frequency, rate, phase);
      out[k] = bipolar ? sin_cos(kTurn * p).sin : 0.5 + 0.5 * sin_cos(kTurn * p).sin;
    }
  }
};

}  // namespace

Entry<Waveform> waveform_sine() {
  return waveform_entry<Sine>("sine", "A sine wave; unipolar swings between 0 and the level.", "gust");
}

}  // namespace gust
