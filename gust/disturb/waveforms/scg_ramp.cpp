#include <cmath>

#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

/// Ramps of random increments d_k = |N(0, increment^2)|, for a level A >= 0; a level below 0 mirrors them:
///
///     sawtooth:  v += d;    v >= A: v = restart
///     triangle:  v += s d;  v >= A: v = A, s = -1;  v <= 0: v = 0, s = 1   (s is 1 at first)
///
/// The mean increment is increment sqrt(2 / pi), so the level sets the period and not the slope.
struct ScgRamp {
  static constexpr bool kRandom = true;
  std::string shape = "sawtooth";
  double increment = 0.01;
  double restart = 0.01;

  static constexpr std::tuple kFields = {
      field("shape", &ScgRamp::shape, "falls back at the level, or turns there and at 0", one_of("sawtooth|triangle")),
      field("increment", &ScgRamp::increment,
            "standard deviation of the normal number whose size is the increment, in the channel's unit", positive),
      field("restart", &ScgRamp::restart, "where a sawtooth begins again, in the channel's unit", non_negative),
  };

  void go_on(WaveState& state, std::span<double> out, double level, Rng rng) const {
    const double top = std::abs(level);
    const bool turns = shape == "triangle";
    for (std::size_t k = 0; k < out.size(); ++k) {
      state.value += state.direction * increment * std::abs(rng.normal(k));
      if (state.value >= top) {
        state.value = turns ? top : restart;
        state.direction = turns ? -1 : 1;
      } else if (state.value <= 0) {
        state.value = 0;
        state.direction = 1;
      }
      out[k] = std::copysign(1.0, level) * state.value;
    }
  }
};

}  // namespace

Entry<Waveform> waveform_scg_ramp() {
  return waveform_entry<ScgRamp>(
      "scg_ramp", "A sawtooth or triangle of random steps up to the level, which goes on from episode to episode.",
      "Glossop et al. 2022: the authors' fork of safe-control-gym (experiment/time_varying_dynamics, 256bf8d)");
}

}  // namespace gust
