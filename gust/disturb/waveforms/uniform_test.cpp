#include <algorithm>
#include <cmath>

#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("uniform noise fills its interval evenly and does not leave it") {
  constexpr int kCount = 100'000;
  const auto made = waveform("uniform", {{"low", number(-1)}, {"high", number(3)}});
  const std::vector<double> values = values_of(made, kCount);
  int quarters[4] = {};

  for (const double value : values) ++quarters[std::clamp(static_cast<int>(std::floor(value + 1)), 0, 3)];

  CHECK(*std::min_element(values.begin(), values.end()) >= -1);
  CHECK(*std::max_element(values.begin(), values.end()) < 3);
  for (const int quarter : quarters) CHECK(std::abs(quarter - kCount / 4) < 5 * std::sqrt(kCount * 3.0 / 16));
  CHECK(made->random());
}

TEST_CASE("uniform noise is the stream's numbers, stretched; by default over [-1, 1)") {
  const Rng rng(8);
  const std::vector<double> values = values_of(waveform("uniform"), 20, 50, rng);

  for (std::size_t k = 0; k < values.size(); ++k) CHECK(values[k] == -1.0 + 2.0 * rng.uniform(k));
}

TEST_CASE("an interval that ends before it begins is refused") {
  CHECK_THROWS_WITH_AS(waveform("uniform", {{"low", number(2)}}), "test: 'low' must not be above 'high', got 2 and 1",
                       Error);
}
