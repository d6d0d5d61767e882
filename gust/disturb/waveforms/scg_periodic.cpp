#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

constexpr double kTurn = 6.283185307179586476925;

/// safe-control-gym's "periodic": its phase is drawn anew at every step, which makes it noise, not a wave.
struct ScgPeriodic {
  static constexpr bool kRandom = true;
  double frequency = 1.0;

  static constexpr std::tuple kFields = {
      field("frequency", &ScgPeriodic::frequency, "periods per second", positive, "Hz")};

  void fill(std::span<double> out, double rate, Rng rng) const {
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k] = sin_cos(kTurn * (phase_at(k, frequency, rate, 0.0) + rng.uniform(k) - 0.5)).sin;
    }
  }
};

}  // namespace

Entry<Waveform> waveform_scg_periodic() {
  return waveform_entry<ScgPeriodic>("scg_periodic", "safe-control-gym's periodic disturbance, for comparison.",
                                     "safe-control-gym, disturbances.py; docs/disturbances.md 3.2");
}

}  // namespace gust
