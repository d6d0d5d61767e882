#include "gust/stats/statistics.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/error.h"

namespace gust {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST_CASE("8.8.4 the interquartile mean of ten values drops two at each end") {
  const std::array values = {0.0, 10.0, 0.0, 3.0, 10.0, 1.0, 0.0, 10.0, 2.0, 10.0};

  CHECK(iqm(values) == doctest::Approx(26.0 / 6.0).epsilon(1e-15));
}

TEST_CASE("every statistic of equal values is that value to the last bit") {
  const std::vector<double> values(10, 0.1);  // ten tenths do not add up to one in binary

  CHECK(mean(values) == 0.1);
  CHECK(median(values) == 0.1);
  CHECK(iqm(values) == 0.1);
  CHECK(quantile(values, 0.3) == 0.1);
  CHECK(sample_deviation(values) == 0.0);
}

TEST_CASE("the median is the middle value, or half way between the two middle ones") {
  CHECK(median(std::array{3.0, 1.0, 2.0}) == 2.0);
  CHECK(median(std::array{4.0, 1.0, 2.0, 8.0}) == 3.0);
  CHECK(median(std::array{7.0}) == 7.0);
}

TEST_CASE("a quantile lies on the straight line between neighbouring values") {
  const std::array values = {8.0, 0.0, 4.0};

  CHECK(quantile(values, 0.0) == 0.0);
  CHECK(quantile(values, 0.25) == 2.0);
  CHECK(quantile(values, 0.75) == 6.0);
  CHECK(quantile(values, 1.0) == 8.0);
}

TEST_CASE("a quantile next to infinite values is infinite and never NaN") {
  const std::array values = {1.0, kInfinity, kInfinity, kInfinity};

  CHECK(quantile(values, 0.0) == 1.0);
  CHECK(quantile(values, 0.1) == kInfinity);
  CHECK(quantile(values, 0.9) == kInfinity);
}

TEST_CASE("the optimality gap ignores what exceeds gamma") {
  CHECK(optimality_gap(std::array{0.5, 2.0}) == 0.25);
  CHECK(optimality_gap(std::array{0.5, 2.0}, 2.0) == 0.75);
}

TEST_CASE("statistics of no values, or with a NaN among them, are NaN") {
  const std::array with_nan = {1.0, kNaN, 2.0, 3.0, 4.0};

  for (const std::span<const double> values : {std::span<const double>{}, std::span<const double>(with_nan)}) {
    CHECK(std::isnan(mean(values)));
    CHECK(std::isnan(median(values)));
    CHECK(std::isnan(iqm(values)));
    CHECK(std::isnan(quantile(values, 0.5)));
    CHECK(std::isnan(sample_deviation(values)));
    CHECK(std::isnan(optimality_gap(values)));
  }
  CHECK(std::isnan(sample_deviation(std::array{1.0})));
}

TEST_CASE("the mean of values with an infinity is infinite") {
  CHECK(mean(std::array{kInfinity, 1.0}) == kInfinity);
  CHECK(mean(std::array{1.0, -kInfinity}) == -kInfinity);
  CHECK(std::isnan(mean(std::array{kInfinity, -kInfinity})));
}

TEST_CASE("a trimmed mean that would leave no value is refused") {
  CHECK_THROWS_AS(trimmed_mean(std::array{1.0, 2.0}, 1), Bug);
  CHECK_THROWS_AS(quantile(std::array{1.0}, 1.5), Bug);
}

}  // namespace
}  // namespace gust
