#include <cmath>

#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("white noise is the stream's normal numbers times its standard deviation") {
  const Rng rng(3);
  const std::vector<double> values = values_of(waveform("white", {{"std", number(0.5)}}), 100, 50, rng);

  for (std::size_t k = 0; k < values.size(); ++k) CHECK(values[k] == 0.5 * rng.normal(k));
  CHECK(waveform("white")->random());
}

TEST_CASE("white noise has mean zero, the standard deviation asked for, and no memory") {
  constexpr int kCount = 200'000;
  const std::vector<double> values = values_of(waveform("white", {{"std", number(2)}}), kCount);
  double mean = 0, variance = 0, memory = 0;

  for (std::size_t k = 0; k < kCount; ++k) {
    mean += values[k] / kCount;
    variance += values[k] * values[k] / kCount;
    memory += k > 0 ? values[k] * values[k - 1] / kCount : 0.0;
  }

  const double unit = 5 / std::sqrt(kCount);  // five standard errors
  CHECK(std::abs(mean) < 2 * unit);
  CHECK(std::abs(variance - 4) < 4 * std::sqrt(2) * unit);
  CHECK(std::abs(memory) < 4 * unit);
}

TEST_CASE("white noise of the same stream does not depend on how long the episode is") {
  const std::vector<double> brief = values_of(waveform("white"), 10);
  const std::vector<double> full = values_of(waveform("white"), 250);

  CHECK(brief == std::vector<double>(full.begin(), full.begin() + 10));
}

TEST_CASE("white noise without spread is refused") {
  CHECK_THROWS_WITH_AS(waveform("white", {{"std", number(0)}}), "test: 'std' must be > 0, got 0", Error);
}
