#include "gust/core/math.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace gust;

namespace {

/// Distance in units in the last place of the long double truth rounded to double.
double ulps(double value, long double truth) {
  const double nearest = static_cast<double>(truth);
  const double unit = std::nextafter(std::abs(nearest), INFINITY) - std::abs(nearest);
  return static_cast<double>(std::abs(static_cast<long double>(value) - truth)) / unit;
}

}  // namespace

TEST_CASE("sine and cosine are within two units in the last place of the C library's long double") {
  double worst = 0;

  for (int i = -200'000; i <= 200'000; ++i) {
    const double x = i * 0.00137 + (i % 97) * 1e-9;
    const auto [sine, cosine] = sin_cos(x);
    worst = std::max({worst, ulps(sine, std::sin(static_cast<long double>(x))),
                      ulps(cosine, std::cos(static_cast<long double>(x)))});
  }

  CHECK(worst < 2.0);
}

TEST_CASE("sine and cosine of zero and of infinity") {
  CHECK(sin_cos(0.0).sin == 0.0);
  CHECK(sin_cos(0.0).cos == 1.0);
  CHECK(std::isnan(sin_cos(static_cast<double>(INFINITY)).sin));
  CHECK(std::isnan(sin_cos(static_cast<double>(NAN)).cos));
}

TEST_CASE("exponential and logarithm are within two units in the last place") {
  double worst_exp = 0;
  double worst_log = 0;

  for (int i = -70'000; i <= 70'000; ++i) {
    const double x = i * 0.01009;
    worst_exp = std::max(worst_exp, ulps(gust::exp(x), std::exp(static_cast<long double>(x))));
    const double y = std::exp(x * 0.5);
    worst_log = std::max(worst_log, ulps(gust::log(y), std::log(static_cast<long double>(y))));
  }

  CHECK(worst_exp < 2.0);
  CHECK(worst_log < 2.0);
}

TEST_CASE("the exponential saturates without trapping") {
  CHECK(gust::exp(-1e9) == 0.0);
  CHECK(gust::exp(-static_cast<double>(INFINITY)) == 0.0);
  CHECK(std::isinf(gust::exp(1e9)));
  CHECK(std::isnan(gust::exp(static_cast<double>(NAN))));
  CHECK(gust::exp(0.0) == 1.0);
}

TEST_CASE("a pack gives the bits of four scalars") {
  for (int i = 1; i < 5000; ++i) {
    const Pack x = {i * 0.013, -i * 7.1, i * 1e-5, -3.0 + i};
    const SinCos<Pack> both = sin_cos(x);
    const Pack exponential = gust::exp(x);
    const Pack logarithm = gust::log(x * x + 1e-9);
    const Pack wrapped = wrap_angle(x);

    for (std::size_t lane = 0; lane < kPackLanes; ++lane) {
      const double scalar = x[lane];
      REQUIRE(both.sin[lane] == sin_cos(scalar).sin);
      REQUIRE(both.cos[lane] == sin_cos(scalar).cos);
      REQUIRE(exponential[lane] == gust::exp(scalar));
      REQUIRE(logarithm[lane] == gust::log(scalar * scalar + 1e-9));
      REQUIRE(wrapped[lane] == wrap_angle(scalar));
    }
  }
}

TEST_CASE("angles wrap into [-pi, pi)") {
  const double pi = 3.14159265358979323846;

  CHECK(wrap_angle(0.25) == 0.25);
  CHECK(wrap_angle(pi) == doctest::Approx(-pi));
  CHECK(wrap_angle(-pi) == doctest::Approx(-pi));
  CHECK(wrap_angle(3 * pi + 0.5) == doctest::Approx(-pi + 0.5));
}
