#include <cmath>

#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("sine is the sine of the phase, within the rounding of the phase") {
  const auto made = waveform("sine", {{"frequency", number(1.7)}, {"phase", number(0.1)}});

  const std::vector<double> values = values_of(made, 250);

  // Up to 8.6 turns, rounded three times: 3 * 2^-50 * 2 pi.
  for (std::size_t k = 0; k < values.size(); ++k) {
    const long double turns = 1.7L * static_cast<long double>(k) / 50 + 0.1L;
    CHECK(std::abs(values[k] - static_cast<double>(std::sin(6.283185307179586476925286766559L * turns))) < 1.7e-14);
  }
}

TEST_CASE("sine starts at zero, and every period gives the same bits where the control step divides it") {
  const std::vector<double> values = values_of(waveform("sine"), 251);

  CHECK(values[0] == 0.0);
  CHECK(values[50] == 0.0);
  CHECK(values[250] == 0.0);
  CHECK(values[12 + 50] == doctest::Approx(values[12]).epsilon(1e-14));
  CHECK(values_of(waveform("sine"), 2, 4)[1] == 1.0);
}

TEST_CASE("unipolar sine swings between 0 and 1") {
  const auto made = waveform("sine", {{"polarity", word("unipolar")}});

  CHECK(values_of(made, 2, 4) == std::vector<double>{0.5, 1});
  CHECK(values_of(made, 4, 4)[3] == 0.0);
}
