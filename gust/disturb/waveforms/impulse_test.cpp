#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("an impulse of width two, two steps in, disturbs steps 2 and 3") {
  CHECK(values_of(waveform("impulse"), 6) == std::vector<double>{0, 0, 1, 1, 0, 0});
}

TEST_CASE("an impulse disturbs exactly as many steps as its duration says, from its offset on") {
  const auto impulse = [](std::int64_t offset, std::int64_t duration) {
    return values_of(waveform("impulse", {{"offset", steps(offset)}, {"duration", steps(duration)}}), 6);
  };

  CHECK(impulse(2, 1) == std::vector<double>{0, 0, 1, 0, 0, 0});
  CHECK(impulse(2, 3) == std::vector<double>{0, 0, 1, 1, 1, 0});
  CHECK(impulse(0, 4) == std::vector<double>{1, 1, 1, 1, 0, 0});
  CHECK(impulse(4, 100) == std::vector<double>{0, 0, 0, 0, 1, 1});
}

TEST_CASE("an impulse decays with the distance to its middle") {
  const auto odd = waveform("impulse", {{"offset", steps(1)}, {"duration", steps(5)}, {"decay", number(0.5)}});
  const auto even = waveform("impulse", {{"offset", steps(0)}, {"duration", steps(4)}, {"decay", number(0.25)}});
  const auto needle = waveform("impulse", {{"offset", steps(0)}, {"duration", steps(3)}, {"decay", number(0)}});

  const std::vector<double> at_odd = values_of(odd, 7);
  const std::vector<double> at_even = values_of(even, 5);

  // Whole and half powers: exp and log are within 2 units in the last place each.
  for (const auto& [k, value] : {std::pair{1, 0.25}, {2, 0.5}, {3, 1.0}, {4, 0.5}, {5, 0.25}, {6, 0.0}}) {
    CHECK(at_odd[static_cast<std::size_t>(k)] == doctest::Approx(value).epsilon(1e-15));
  }
  for (const auto& [k, value] : {std::pair{0, 0.125}, {1, 0.5}, {2, 0.5}, {3, 0.125}, {4, 0.0}}) {
    CHECK(at_even[static_cast<std::size_t>(k)] == doctest::Approx(value).epsilon(1e-15));
  }
  CHECK(values_of(needle, 4) == std::vector<double>{0, 1, 0, 0});
}

TEST_CASE("an impulse without width or with growth is refused") {
  CHECK_THROWS_WITH_AS(waveform("impulse", {{"duration", steps(0)}}), "test: 'duration' must be >= 1, got 0", Error);
  CHECK_THROWS_WITH_AS(waveform("impulse", {{"decay", number(1.5)}}), "test: 'decay' must be 0 to 1, got 1.5", Error);
}
