#pragma once

#include <memory>

#include "gust/disturb/waveform.h"

namespace gust {

/// The waveform of a struct of options with `void fill(std::span<double>, double rate, Rng) const`; or, where the level
/// is more than a factor, with `void go_on(WaveState&, std::span<double>, double level, Rng) const`. It is random if
/// the struct says `static constexpr bool kRandom = true`. The options `offset` [control steps] and `frequency` [Hz]
/// say when the shape begins and how often it repeats.
template <class Options>
class OptionsWaveform final : public Waveform {
 public:
  explicit OptionsWaveform(const Options& options) : options_(options) {}

  void fill(std::span<double> out, double rate, Rng rng) const override {
    WaveState start;
    if constexpr (kScales)
      options_.fill(out, rate, rng);
    else
      options_.go_on(start, out, 1.0, rng);
  }
  bool scales() const override { return kScales; }
  void go_on(WaveState& state, std::span<double> out, double level, Rng rng) const override {
    GUST_CHECK(!kScales);
    if constexpr (!kScales) options_.go_on(state, out, level, rng);
  }
  bool random() const override {
    if constexpr (requires { Options::kRandom; }) return Options::kRandom;
    return false;
  }
  std::int64_t onset() const override {
    if constexpr (requires { options_.offset; }) return options_.offset;
    return 0;
  }
  double frequency() const override {
    if constexpr (requires { options_.frequency; }) return options_.frequency;
    return 0;
  }

 private:
  static constexpr bool kScales =
      requires(const Options& options, std::span<double> out, Rng rng) { options.fill(out, 0.0, rng); };
  Options options_;
};

template <class Options>
Entry<Waveform> waveform_entry(std::string name, std::string summary, std::string source) {
  return make_entry<Waveform, Options>(
      std::move(name), std::move(summary), std::move(source),
      [](const Options& options) { return std::make_unique<OptionsWaveform<Options>>(options); });
}

/// Position within a period, in [0, 1), of control step k: computed in this form so that periods that the control
/// step divides end exactly.
inline double phase_at(std::size_t k, double frequency, double rate, double phase) {
  const double periods = frequency * static_cast<double>(k) / rate + phase;
  return periods - __builtin_floor(periods);
}

/// base to the exponent for base in [0, 1], with bits that do not depend on the C library.
inline double power(double base, double exponent) {
  if (base == 1.0 || exponent == 0.0) return 1.0;
  return base == 0.0 ? 0.0 : exp(exponent * log(base));
}

}  // namespace gust
