#include <algorithm>
#include <cmath>

#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("safe-control-gym's periodic disturbance is noise with the arcsine distribution, not a wave") {
  constexpr int kCount = 200'000;
  const std::vector<double> values = values_of(waveform("scg_periodic"), kCount);
  double mean = 0, square = 0, memory = 0;
  int inner_half = 0;

  for (std::size_t k = 0; k < kCount; ++k) {
    mean += values[k] / kCount;
    square += values[k] * values[k] / kCount;
    memory += k >= 50 ? values[k] * values[k - 50] / kCount : 0.0;
    inner_half += std::abs(values[k]) < 0.5 ? 1 : 0;
  }

  // Of sin(phi), phi uniform: mean 0, variance 1/2, P(|.| < 1/2) = 1/3. Five standard errors.
  const double unit = 5 / std::sqrt(kCount);
  CHECK(std::abs(mean) < unit * std::sqrt(0.5));
  CHECK(std::abs(square - 0.5) < unit * std::sqrt(0.125));
  CHECK(std::abs(memory) < unit * 0.5);
  CHECK(std::abs(inner_half / static_cast<double>(kCount) - 1.0 / 3) < unit * std::sqrt(2.0 / 9));
  CHECK(waveform("scg_periodic")->random());
}
