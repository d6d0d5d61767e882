#include "gust/core/dual.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace gust;

namespace {

using D = Dual<2>;

const D kX = D::input(0.7, 0);
const D kY = D::input(-1.3, 1);

}  // namespace

TEST_CASE("sums, products and quotients carry their exact derivatives") {
  const double x = 0.7;
  const double y = -1.3;

  CHECK((kX + kY).slope == std::array{1.0, 1.0});
  CHECK((kX - kY).slope == std::array{1.0, -1.0});
  CHECK((kX * kY).value == x * y);
  CHECK((kX * kY).slope == std::array{y, x});
  CHECK((kX / kY).value == x / y);
  CHECK((kX / kY).slope[0] == 1 / y);
  CHECK((kX / kY).slope[1] == doctest::Approx(-x / (y * y)).epsilon(1e-15));
  CHECK((-kX).slope == std::array{-1.0, 0.0});
  CHECK((kX * kX).slope[0] == 2 * x);
}

TEST_CASE("constants have no slope") {
  CHECK((kX + 3.0).slope == std::array{1.0, 0.0});
  CHECK((3.0 * kX).slope == std::array{3.0, 0.0});
  CHECK((kX - kX).slope == std::array{0.0, 0.0});
  CHECK(D(5.0).slope == std::array{0.0, 0.0});
}

TEST_CASE("sine and cosine are each other's derivative") {
  const auto [sine, cosine] = sin_cos(kX * kY);

  CHECK(sine.value == sin_cos(0.7 * -1.3).sin);
  CHECK(sine.slope[0] == -1.3 * cosine.value);
  CHECK(sine.slope[1] == 0.7 * cosine.value);
  CHECK(cosine.slope[0] == -1.3 * -sine.value);
}

TEST_CASE("comparing and selecting go by the value and keep the slope") {
  CHECK(kY < kX);
  CHECK(kX > 0.0);
  CHECK(kX <= kX);
  CHECK(kX >= kY);
  CHECK(select(kX > 0.0, kX, kY).slope == std::array{1.0, 0.0});
  CHECK(absolute(kY).value == 1.3);
  CHECK(absolute(kY).slope == std::array{0.0, -1.0});
}

TEST_CASE("the derivative of a long expression is that of a finite difference") {
  const auto f = [](auto x, auto y) {
    const auto both = sin_cos(x * y + 0.3);
    return both.sin * both.sin / (2.0 + both.cos * x) - y;
  };
  const double h = 1e-6;

  const D exact = f(kX, kY);

  // A central difference is good to h^2 = 1e-12 and to rounding / h = 1e-10.
  CHECK(exact.slope[0] == doctest::Approx((f(0.7 + h, -1.3) - f(0.7 - h, -1.3)) / (2 * h)).epsilon(1e-8));
  CHECK(exact.slope[1] == doctest::Approx((f(0.7, -1.3 + h) - f(0.7, -1.3 - h)) / (2 * h)).epsilon(1e-8));
}
