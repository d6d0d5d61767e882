#include "gust/core/units.h"

#include <doctest/doctest.h>

#include <numbers>

using namespace gust;

TEST_CASE("a quantity in another unit is its number in SI units times the factor") {
  CHECK(units_in("m", "m", "x", {}) == 1.0);
  CHECK(units_in("cm", "m", "x", {}) == 100.0);
  CHECK(units_in("km/h", "m/s", "x_dot", {}) == 3.6);
  CHECK(std::numbers::pi * units_in("deg", "rad", "theta", {}) == doctest::Approx(180.0).epsilon(1e-15));
  CHECK(2 * std::numbers::pi * units_in("rpm", "rad/s", "theta_dot", {}) == doctest::Approx(60.0).epsilon(1e-15));
  CHECK(0.0254 * units_in("in", "m", "x", {}) == doctest::Approx(1.0).epsilon(1e-15));
  CHECK(9.80665 * units_in("gf", "N", "force", {}) == doctest::Approx(1000.0).epsilon(1e-15));
}

TEST_CASE("a unit of another dimension is an error that lists those of the quantity") {
  CHECK_THROWS_WITH_AS(units_in("rad", "m", "x", {"s.toml", 3, 9}),
                       "s.toml:3:9: 'rad' is no unit of x [m]; units are m, cm, mm, km, in, ft", Error);
  CHECK_THROWS_WITH_AS(
      units_in("degs/s", "rad/s", "theta_dot", {"s.toml", 3, 9}),
      "s.toml:3:9: 'degs/s' is no unit of theta_dot [rad/s]; did you mean 'deg/s'?; units are rad/s, mrad/s, deg/s, "
      "turn/s, rpm",
      Error);
}
