#include <cmath>
#include <cstring>

#include "gust/disturb/waveform_entry.h"
#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("every waveform gives finite values, the same bits for the same stream, and needs a stream only if random") {
  for (const Entry<Waveform>& entry : waveforms().entries()) {
    CAPTURE(entry.name);
    const Made<Waveform> made = waveform(entry.name);

    const std::vector<double> once = values_of(made, 251, 50, Rng(1));
    const std::vector<double> again = values_of(waveform(entry.name), 251, 50, Rng(1));
    const std::vector<double> other = values_of(made, 251, 50, Rng(2));

    for (const double value : once) CHECK(std::isfinite(value));
    CHECK(std::memcmp(once.data(), again.data(), once.size() * sizeof(double)) == 0);
    CHECK((once == other) == !made->random());
    CHECK(made.canonical().starts_with(entry.name + "("));
    CHECK_FALSE(entry.summary.empty());
    CHECK_FALSE(entry.source.empty());
  }
}

TEST_CASE("the catalogue holds the waveforms that the specification names") {
  CHECK(waveforms().names() == std::vector<std::string>{"white", "uniform", "step", "impulse", "sawtooth", "triangle",
                                                        "sine", "constant", "scg_impulse", "scg_periodic", "scg_ramp"});
}

TEST_CASE("deterministic waveforms that never rest have the mean that their polarity says") {
  for (const char* kind : {"sawtooth", "triangle", "sine"}) {
    CAPTURE(kind);
    for (const char* polarity : {"bipolar", "unipolar"}) {
      // A power of two of steps a period: all phases are exact, and the sawtooth's mean lies half a step low.
      const std::vector<double> values = values_of(waveform(kind, {{"polarity", word(polarity)}}), 1024, 1024);
      double mean = 0;
      for (const double value : values) mean += value / 1024;
      CHECK(std::abs(mean - (polarity[0] == 'b' ? 0.0 : 0.5)) <= 1.0 / 1024 + 1e-15);
    }
  }
}

TEST_CASE("powers of the decay are exact at their ends and accurate between") {
  CHECK(power(1.0, 1e300) == 1.0);
  CHECK(power(0.0, 0.0) == 1.0);
  CHECK(power(0.0, 2.0) == 0.0);
  CHECK(power(0.9, 7.5) == doctest::Approx(std::pow(0.9, 7.5)).epsilon(1e-14));
  CHECK(power(1e-300, 3.0) == 0.0);
}

TEST_CASE("the phase is frac(frequency k / rate + phase), also for negative phases") {
  CHECK(phase_at(0, 1.0, 50.0, 0.0) == 0.0);
  CHECK(phase_at(25, 1.0, 50.0, 0.0) == 0.5);
  CHECK(phase_at(100, 1.0, 50.0, 0.0) == 0.0);
  CHECK(phase_at(0, 1.0, 50.0, -0.25) == 0.75);
  CHECK(phase_at(3, 0.7, 15.0, 0.125) == 0.7 * 3.0 / 15.0 + 0.125);
}
