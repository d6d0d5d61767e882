#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("sawtooth ramps from -1 and falls back after one period") {
  const auto made = waveform("sawtooth", {{"frequency", number(2)}});

  CHECK(values_of(made, 9, 8) == std::vector<double>{-1, -0.5, 0, 0.5, -1, -0.5, 0, 0.5, -1});
}

TEST_CASE("unipolar sawtooth ramps from 0 towards 1") {
  const auto made = waveform("sawtooth", {{"frequency", number(2)}, {"polarity", word("unipolar")}});

  CHECK(values_of(made, 6, 8) == std::vector<double>{0, 0.25, 0.5, 0.75, 0, 0.25});
}

TEST_CASE("the phase moves sawtooth's start within the period, whole periods do nothing") {
  const auto quarter = waveform("sawtooth", {{"frequency", number(2)}, {"phase", number(0.25)}});
  const auto back = waveform("sawtooth", {{"frequency", number(2)}, {"phase", number(-1.75)}});

  CHECK(values_of(quarter, 5, 8) == std::vector<double>{-0.5, 0, 0.5, -1, -0.5});
  CHECK(values_of(back, 5, 8) == values_of(quarter, 5, 8));
}

TEST_CASE("periods that the control step divides end exactly, to the end of the episode") {
  for (const double frequency : {0.5, 1.0, 2.0, 5.0}) {
    const auto made = waveform("sawtooth", {{"frequency", number(frequency)}});
    const std::vector<double> values = values_of(made, 251);
    const auto period = static_cast<std::size_t>(50 / frequency);
    CAPTURE(frequency);
    for (std::size_t k = 0; k < values.size(); k += period) CHECK(values[k] == -1.0);
    for (std::size_t k = 1; k < period; ++k) CHECK(values[k] > values[k - 1]);
  }
}

TEST_CASE("the default sawtooth has a period of 50 steps at 50 Hz; frequency and polarity are checked") {
  CHECK(values_of(waveform("sawtooth"), 51)[25] == 0.0);
  CHECK(values_of(waveform("sawtooth"), 51)[50] == -1.0);
  CHECK_THROWS_WITH_AS(waveform("sawtooth", {{"frequency", number(0)}}), "test: 'frequency' must be > 0, got 0", Error);
  CHECK_THROWS_WITH_AS(waveform("sawtooth", {{"polarity", word("both")}}),
                       "test: 'polarity' must be one of bipolar, unipolar, got 'both'", Error);
}
