#include <algorithm>
#include <cmath>

#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

namespace {

constexpr double kMeanIncrement = 0.007978845608028654;            // 0.01 sqrt(2 / pi), the mean of |N(0, 0.01^2)|
constexpr double kOvershoot = 0.01 * 0.01 / (2 * kMeanIncrement);  // beyond a level: E d^2 / (2 E d), renewal theory

Made<Waveform> ramp(const std::string& shape) { return waveform("scg_ramp", {{"shape", word(shape)}}); }

std::vector<double> wave(const std::string& shape, double level, std::size_t count, Rng rng = Rng(1)) {
  std::vector<double> values(count);
  WaveState state;
  ramp(shape)->go_on(state, values, level, rng);
  return values;
}

/// How many values of a long wave one period has.
double mean_period(const std::string& shape, double level) {
  constexpr std::size_t kCount = 400'000;
  const std::vector<double> values = wave(shape, level, kCount);
  const double start = shape == "sawtooth" ? 0.01 : 0.0;
  return static_cast<double>(kCount) / static_cast<double>(std::ranges::count(values, start));
}

}  // namespace

TEST_CASE("a sawtooth of random increments has a period of level / 0.00798 steps, and a triangle twice that") {
  for (const double level : {0.1, 0.5, 1.5}) {
    CAPTURE(level);
    // A period has n = level / 0.00798 steps give or take 0.76 sqrt(n), and there are 400000 / n: 0.5 % is four sigma.
    CHECK(mean_period("sawtooth", level) ==
          doctest::Approx((level - 0.01 + kOvershoot) / kMeanIncrement).epsilon(0.005));
    CHECK(mean_period("triangle", level) == doctest::Approx(2 * (level + kOvershoot) / kMeanIncrement).epsilon(0.005));
    CHECK(mean_period("sawtooth", level) == doctest::Approx(level / kMeanIncrement).epsilon(0.05));
  }
}

TEST_CASE("an episode of 250 steps travels 2.0, give or take 0.1, whatever the level") {
  constexpr std::size_t kEpisodes = 4000;
  double mean = 0, square = 0;

  for (std::size_t e = 0; e < kEpisodes; ++e) {
    const double travel = wave("sawtooth", 1e6, 250, Rng(7).split(e)).back();
    mean += travel / kEpisodes;
    square += travel * travel / kEpisodes;
  }

  const double spread = 0.01 * std::sqrt(250 * (1 - 2 / 3.141592653589793));  // 0.0953
  CHECK(std::abs(mean - 250 * kMeanIncrement) < 5 * spread / std::sqrt(kEpisodes));
  CHECK(std::sqrt(square - mean * mean) == doctest::Approx(spread).epsilon(5 / std::sqrt(2.0 * kEpisodes)));
}

TEST_CASE("increments are sizes of the stream's normal numbers, and ends are met exactly") {
  const Rng rng(3);
  double saw = 0, triangle = 0, direction = 1;
  const std::vector<double> saws = wave("sawtooth", 0.05, 500, rng), triangles = wave("triangle", 0.05, 500, rng);

  for (std::size_t k = 0; k < 500; ++k) {
    const double increment = 0.01 * std::abs(rng.normal(k));
    saw = saw + increment >= 0.05 ? 0.01 : saw + increment;
    triangle = std::clamp(triangle + direction * increment, 0.0, 0.05);
    direction = triangle == 0.05 ? -1 : triangle == 0.0 ? 1 : direction;
    CHECK(saws[k] == saw);
    CHECK(triangles[k] == triangle);
  }
}

TEST_CASE("at level 0 the sawtooth is a bias of its restart, and the triangle is nothing") {
  CHECK(wave("sawtooth", 0, 50) == std::vector<double>(50, 0.01));
  CHECK(wave("triangle", 0, 50) == std::vector<double>(50, 0.0));
}

TEST_CASE("a level below 0 mirrors the ramp") {
  for (const char* shape : {"sawtooth", "triangle"}) {
    const std::vector<double> up = wave(shape, 0.3, 200), down = wave(shape, -0.3, 200);
    for (std::size_t k = 0; k < up.size(); ++k) CHECK(down[k] == -up[k]);
  }
}

TEST_CASE("a ramp goes on where it was, direction and all") {
  for (const char* shape : {"sawtooth", "triangle"}) {
    CAPTURE(shape);
    for (const std::size_t first : {1u, 60u, 137u, 199u}) {
      std::vector<double> parts(200);
      WaveState state;
      double direction = 1;
      // The second piece has a stream of its own; what it goes on from is the end of the first.
      ramp(shape)->go_on(state, std::span(parts).first(first), 0.3, Rng(1));
      if (std::string(shape) == "triangle") direction = state.direction;
      const double before = state.value;
      ramp(shape)->go_on(state, std::span(parts).subspan(first), 0.3, Rng(2));

      CHECK(parts[first - 1] == before);
      const double step = direction * 0.01 * std::abs(Rng(2).normal(0));
      const bool inside = before + step > 0 && before + step < 0.3;
      if (inside) CHECK(parts[first] == before + step);
      CHECK(parts.back() == state.value);
    }
  }
}

TEST_CASE("a level is no factor of a ramp, and is one of every other waveform") {
  for (const Entry<Waveform>& entry : waveforms().entries())
    CHECK(waveform(entry.name)->scales() == (entry.name != "scg_ramp"));
  CHECK(values_of(waveform("scg_ramp"), 40, 50, Rng(5)) == wave("sawtooth", 1.0, 40, Rng(5)));
  CHECK_THROWS_WITH_AS(waveform("scg_ramp", {{"shape", word("triangel")}}),
                       doctest::Contains("did you mean 'triangle'?"), Error);
}
