#include "gust/eval/margin.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/error.h"

namespace gust {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A curve over levels 0, 1, 2, …; a row of scores a level, with the seeds' episodes one after another.
struct Scene {
  std::vector<std::vector<double>> scores;
  std::size_t seeds = 1;
  std::vector<double> levels = {};
  std::vector<Cell> cells = {};

  Curve curve() {
    levels.clear();
    cells.clear();
    for (const auto& row : scores) {
      levels.push_back(static_cast<double>(levels.size()));
      cells.push_back(cell_of(row, seeds));
    }
    return {levels, cells};
  }
};

TEST_CASE("a score crosses where the straight line between two levels meets the threshold") {
  const std::array levels = {0.0, 2.0, 4.0};

  CHECK(crossing(levels, std::array{8.0, 8.0, 4.0}, {.fraction = 0.75}) == 3.0);
  CHECK(crossing(levels, std::array{8.0, 8.0, 4.0}, {.fraction = 0.75, .interpolated = false}) == 4.0);
  CHECK(crossing(levels, std::array{8.0, 6.0, 5.0}, {.fraction = 0.75}) == 2.0);  // equal is not below
  CHECK(crossing(levels, std::array{8.0, 7.0, 6.0}, {.fraction = 0.75}) == kInfinity);
  CHECK(crossing(levels, std::array{8.0, 4.0, 9.0}, {.fraction = 0.75}) == 1.0);  // the first crossing counts
  CHECK(std::isnan(crossing(levels, std::array{0.0, 4.0, 9.0}, {})));
  CHECK(std::isnan(crossing(levels, std::array{-1.0, 4.0, 9.0}, {})));
  CHECK(std::isnan(crossing(levels, std::array{kNaN, 4.0, 9.0}, {})));
}

TEST_CASE("the margin of seeds lies between those of its best and its worst seed") {
  Bootstrap bootstrap(Rng(1));
  Scene scene{{{1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}, {0.8, 1.0, 0.8}, {0.6, 0.8, 0.6}}, 3};

  const Margin found = margin(scene.curve(), {}, bootstrap);

  // All three draws are one and the same seed in 1 of 27 resamples: 1.5 for the worse two, 2.5 for the better.
  CHECK_FALSE(found.censored);
  CHECK(found.level.estimate == doctest::Approx(1.75).epsilon(1e-14));
  CHECK(found.level.low == doctest::Approx(1.5).epsilon(1e-14));
  CHECK(found.level.high == doctest::Approx(2.5).epsilon(1e-14));
  CHECK(found.level.unit == Unit::seeds);
  CHECK(found.level.n == 3);
  CHECK(margin_text(found) == "1.75 [1.5, 2.5]");
}

TEST_CASE("a margin beyond the grid is censored at the last level") {
  Bootstrap bootstrap(Rng(2));
  Scene scene{{{1.0, 1.0, 1.0}, {1.0, 0.95, 1.0}}, 3};

  const Margin found = margin(scene.curve(), {}, bootstrap);

  CHECK(found.censored);
  CHECK(found.level.estimate == 1.0);
  CHECK(found.level.low == 1.0);
  CHECK(found.level.high == kInfinity);
  CHECK(margin_text(found) == "≥ 1");
}

TEST_CASE("an interval may reach beyond the grid while the estimate does not") {
  Bootstrap bootstrap(Rng(3));
  Scene scene{{{1.0, 1.0, 1.0}, {1.0, 0.0, 0.8}}, 3};

  const Margin found = margin(scene.curve(), {}, bootstrap);

  CHECK_FALSE(found.censored);
  CHECK(found.level.estimate == doctest::Approx(0.25).epsilon(1e-14));
  CHECK(found.level.low == doctest::Approx(0.1).epsilon(1e-14));
  CHECK(found.level.high == kInfinity);
  CHECK(margin_text(found) == "0.25 [0.1, ≥ 1]");
}

TEST_CASE("the margin of a single seed is resampled over episodes with their whole curves") {
  Bootstrap bootstrap(Rng(4));
  Scene scene{{{1.0, 1.0, 1.0}, {0.8, 0.6, 0.8}}, 1};

  const Margin found = margin(scene.curve(), {.statistic = Statistic::iqm}, bootstrap);

  CHECK(found.level.unit == Unit::episodes);
  CHECK(found.level.n == 3);
  CHECK(found.level.estimate == doctest::Approx(0.375).epsilon(1e-14));
  CHECK(found.level.low == doctest::Approx(0.25).epsilon(1e-14));
  CHECK(found.level.high == doctest::Approx(0.5).epsilon(1e-14));
}

TEST_CASE("a margin of single values has no interval") {
  Bootstrap bootstrap(Rng(5));
  Scene scene{{{1.0}, {0.8}}, 1};

  const Margin found = margin(scene.curve(), {}, bootstrap);

  CHECK(found.level.estimate == doctest::Approx(0.5).epsilon(1e-14));
  CHECK(std::isnan(found.level.low));
  CHECK(margin_text(found) == "0.5");
}

TEST_CASE("a score that is NaN counts as zero") {
  Bootstrap bootstrap(Rng(6));
  Scene with_nan{{{1.0, 1.0}, {kNaN, 1.0}, {kNaN, kNaN}}, 2};
  Scene with_zero{{{1.0, 1.0}, {0.0, 1.0}, {0.0, 0.0}}, 2};

  const Margin found = margin(with_nan.curve(), {}, bootstrap);
  const Margin expected = margin(with_zero.curve(), {}, bootstrap);

  CHECK(found.level.estimate == expected.level.estimate);
  CHECK(found.level.low == expected.level.low);
  CHECK(found.level.high == expected.level.high);
  CHECK(areas(with_nan.curve()) == areas(with_zero.curve()));
}

TEST_CASE("without a positive nominal score there is no margin") {
  Bootstrap bootstrap(Rng(7));
  Scene scene{{{0.0, 0.0}, {0.0, 0.0}}, 2};

  const Margin found = margin(scene.curve(), {}, bootstrap);

  CHECK(std::isnan(found.level.estimate));
  CHECK(std::isnan(found.level.high));
  CHECK_FALSE(found.censored);
  CHECK(margin_text(found) == "none");
}

TEST_CASE("L50 is the first level of the grid with less than half the nominal score") {
  Bootstrap bootstrap(Rng(8));
  Scene scene{{{1.0, 0.9}, {0.8, 0.8}, {0.4, 0.6}, {0.1, 0.2}}, 2};

  const Margin found = margin(scene.curve(), kHalfScore, bootstrap);

  CHECK(found.level.estimate == 3.0);
  CHECK(found.level.low == 2.0);
  CHECK(found.level.high == 3.0);
}

TEST_CASE("the area under a curve is its mean score over the range") {
  Bootstrap bootstrap(Rng(9));
  const std::vector<double> scores = {1.0, 0.5, 0.0};
  const std::array levels = {0.0, 1.0, 4.0};
  const std::array cells = {cell_of(std::span(scores).subspan(0, 1), 1), cell_of(std::span(scores).subspan(1, 1), 1),
                            cell_of(std::span(scores).subspan(2, 1), 1)};

  CHECK(areas({levels, cells}) == std::vector{0.375});
  CHECK(areas({std::span(levels).first(1), std::span(cells).first(1)}) == std::vector{1.0});
  CHECK(area({levels, cells}, bootstrap).unit == Unit::none);
}

TEST_CASE("the interval of an area is over seeds") {
  Bootstrap bootstrap(Rng(10));
  Scene scene{{{1.0, 1.0, 1.0}, {1.0, 0.0, 0.5}}, 3};

  const Interval found = area(scene.curve(), bootstrap);

  CHECK(found.estimate == 0.75);
  CHECK(found.low == 0.5);
  CHECK(found.high == 1.0);
  CHECK(found.unit == Unit::seeds);
}

TEST_CASE("a score falls short of the best below the rule's fraction of it") {
  CHECK_FALSE(falls_short(0.9, 1.0));
  CHECK(falls_short(0.875, 1.0));
  CHECK_FALSE(falls_short(0.875, 1.0, kHalfScore));
  CHECK_FALSE(falls_short(-3.0, -1.0));
  CHECK_FALSE(falls_short(std::nan(""), 1.0));
}

TEST_CASE("levels that do not ascend and cells of different shape are refused") {
  Bootstrap bootstrap(Rng(11));
  Scene scene{{{1.0, 1.0}, {1.0}}, 1};
  const std::vector<double> scores = {1.0};
  const std::array cells = {cell_of(scores, 1), cell_of(scores, 1)};

  CHECK_THROWS_AS(margin(scene.curve(), {}, bootstrap), Bug);
  CHECK_THROWS_AS(margin({std::array{1.0, 1.0}, cells}, {}, bootstrap), Bug);
  CHECK_THROWS_AS(margin({std::array{1.0}, cells}, {}, bootstrap), Bug);
}

}  // namespace
}  // namespace gust
