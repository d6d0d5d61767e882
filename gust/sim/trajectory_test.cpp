#include "gust/sim/trajectory.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/core/math.h"

using namespace gust;

TEST_CASE("a circle goes round its centre at constant speed") {
  const Trajectory circle{"circle", -0.5, 5};
  for (double time = 0; time < 5; time += 0.1) {
    const CurvePosition at = curve_position(circle, time);
    CHECK(std::hypot(at.a, at.b) == doctest::Approx(0.5).epsilon(1e-14));
    CHECK(std::hypot(at.a_dot, at.b_dot) == doctest::Approx(2 * kPi * 0.5 / 5).epsilon(1e-14));
  }
  const CurvePosition start = curve_position(circle, 0);
  CHECK(start.a == -0.5);
  CHECK(start.b == 0.0);
}

TEST_CASE("rates are the derivatives of positions") {
  const double h = 1e-6;
  for (const char* shape : {"circle", "figure8", "square"}) {
    const Trajectory trajectory{shape, 0.8, 4};
    for (double time = 0.05; time < 8; time += 0.3) {  // never across a corner of the square
      const CurvePosition before = curve_position(trajectory, time - h);
      const CurvePosition at = curve_position(trajectory, time);
      const CurvePosition after = curve_position(trajectory, time + h);
      CHECK(at.a_dot == doctest::Approx((after.a - before.a) / (2 * h)).epsilon(1e-7));
      CHECK(at.b_dot == doctest::Approx((after.b - before.b) / (2 * h)).epsilon(1e-7));
    }
  }
}

TEST_CASE("a square has four corners at the quarters of its period") {
  const Trajectory square{"square", 2, 8};
  const double corners[5][2] = {{0, 0}, {0, 2}, {-2, 2}, {-2, 0}, {0, 0}};
  for (int corner = 0; corner < 5; ++corner) {
    const CurvePosition at = curve_position(square, 2.0 * corner);
    CHECK(at.a == corners[corner][0]);
    CHECK(at.b == corners[corner][1]);
  }
  const CurvePosition side = curve_position(square, 3);
  CHECK(side.a == -1.0);
  CHECK(side.a_dot == -1.0);
  CHECK(side.b == 2.0);
}

TEST_CASE("a square that is run through more often than an integer can count stays on its sides") {
  const Trajectory frantic{"square", 2, 1e-300};
  const CurvePosition at = curve_position(frantic, 1.0);
  CHECK((at.a >= -2.0 && at.a <= 0.0));
  CHECK((at.b >= 0.0 && at.b <= 2.0));
}

TEST_CASE("a figure of eight crosses its centre twice in a period") {
  const Trajectory eight{"figure8", 1, 4};
  for (const double time : {0.0, 2.0, 4.0}) {
    CHECK(std::abs(curve_position(eight, time).a) < 1e-15);
    CHECK(std::abs(curve_position(eight, time).b) < 1e-15);
  }
}
