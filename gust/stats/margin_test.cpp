#include "gust/stats/margin.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/error.h"
#include "gust/core/rng.h"

namespace gust {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Scores along levels 0, 1, 2, …, one a seed; the first row is the undisturbed one.
MarginCurve curve_of(std::vector<std::vector<double>> scores) {
  MarginCurve curve{.undisturbed = scores.front(), .unit = Unit::seeds};
  for (std::size_t i = 0; i < scores.size(); ++i) curve.add(static_cast<double>(i), scores[i]);
  return curve;
}

TEST_CASE("a score crosses where the straight line between two levels meets the threshold") {
  const std::array levels = {0.0, 2.0, 4.0};
  const auto level = [&](std::array<double, 3> scores, MarginRule rule) {
    const Bounds found = crossing(levels, scores, scores.front(), rule);
    CHECK(found.exact());
    return found.low;
  };

  CHECK(level({8.0, 8.0, 4.0}, {.fraction = 0.75}) == 3.0);
  CHECK(level({8.0, 8.0, 4.0}, {.fraction = 0.75, .interpolated = false}) == 4.0);
  CHECK(level({8.0, 6.0, 5.0}, {.fraction = 0.75}) == 2.0);  // equal is not below
  CHECK(level({8.0, 4.0, 9.0}, {.fraction = 0.75}) == 1.0);  // the first crossing counts
  for (const double undisturbed : {0.0, -1.0, kNaN}) CHECK(std::isnan(level({undisturbed, 4.0, 9.0}, {})));
}

TEST_CASE("a score that crosses beyond the levels or before the first one is a bound") {
  const std::array levels = {1.0, 2.0}, from_zero = {0.0, 2.0};
  const std::array high = {8.0, 7.0}, low = {5.0, 4.0};

  const Bounds beyond = crossing(levels, high, 8.0, {.fraction = 0.75});
  const Bounds before = crossing(levels, low, 8.0, {.fraction = 0.75});
  const Bounds spent = crossing(from_zero, low, 8.0, {.fraction = 0.75});
  const Bounds first = crossing(levels, low, 8.0, {.fraction = 0.75, .interpolated = false});

  CHECK(beyond.low == 2.0);
  CHECK(beyond.high == kInfinity);
  CHECK(before.low == 0.0);
  CHECK(before.high == 1.0);
  CHECK(spent.exact());
  CHECK(spent.low == 0.0);
  CHECK(first.low == 1.0);
  CHECK(first.exact());
}

TEST_CASE("the interval of a margin reaches out to the levels that were looked at") {
  const Margin found = margin(curve_of({{1, 1, 1}, {1, 1, 1}, {0.8, 1, 0.8}, {0.6, 0.8, 0.6}, {0, 0, 0}}));

  CHECK_FALSE(found.censored);
  CHECK(found.level.estimate == doctest::Approx(1.75).epsilon(1e-14));
  CHECK(found.level.low == 0.0);   // three units that fall at 1.5, 1.5 and 2.5 exclude little
  CHECK(found.level.high == 4.0);  // at level 3 a t-test excludes nothing: 0.667 - 0.9 with a half width of 0.287
  CHECK(found.level.unit == Unit::seeds);
  CHECK(found.level.n == 3);
  CHECK(margin_text(found) == "1.75 [0, 4]");
}

TEST_CASE("the bands are Student's interval of the mean") {
  const MarginCurve curve{{1.0}, {{1.0, 1.2, 0.85, 1.1}}, {1.0, 1.0, 1.0, 1.0}, Unit::seeds};

  const MarginBands bands = margin_bands(curve, {});

  // Of 0.1, 0.3, -0.05, 0.2: mean 0.1375, standard error 0.0746520; the table's t for 3 degrees of freedom is 3.182446.
  CHECK(bands.value.front() == doctest::Approx(0.1375).epsilon(1e-12));
  CHECK(bands.low.front() == doctest::Approx(0.1375 - 3.182446 * 0.0746520).epsilon(1e-5));
  CHECK(bands.high.front() == doctest::Approx(0.1375 + 3.182446 * 0.0746520).epsilon(1e-5));
}

TEST_CASE("a margin beyond the levels is at least the last one, below them at most the first") {
  const Margin beyond = margin(curve_of({{1, 1, 1}, {1, 0.95, 1}}));
  CHECK(beyond.censored);
  CHECK(beyond.level.estimate == 1.0);
  CHECK(beyond.level.low == 1.0);
  CHECK(beyond.level.high == kInfinity);
  CHECK(margin_text(beyond) == "≥ 1");

  const Margin below = margin({{0.5, 1.0}, {{0.1}, {0.0}}, {1.0}, Unit::none});
  CHECK(below.at_most);
  CHECK_FALSE(below.censored);
  CHECK(margin_text(below) == "≤ 0.5");
}

TEST_CASE("a score that has fallen at a millionth of the last level has a margin of at most that") {
  const Margin fallen = margin({{0.0, 2e-6, 2.0}, {{1.0}, {0.1}, {0.0}}, {1.0}, Unit::none});
  CHECK(fallen.at_most);
  CHECK(fallen.level.estimate == 2e-6);
  CHECK(margin_text(fallen) == "≤ 2e-06");

  const Margin some = margin({{0.0, 2e-6, 2.0}, {{1, 1, 1}, {1, 1, 0}, {1, 1, 0}}, {1, 1, 1}, Unit::seeds});
  CHECK(some.at_most);
  CHECK(margin_text(some) == "≤ 2e-06 [0, ≥ 2]");

  CHECK_FALSE(margin({{0.0, 3e-6, 2.0}, {{1.0}, {0.1}, {0.0}}, {1.0}, Unit::none}).at_most);
}

TEST_CASE("what has lost a tenth before the level grows has the margin 0") {
  const MarginCurve curve{{0.0, 1.0}, {{0.5, 0.6}, {0.5, 0.6}}, {1.0, 1.0}, Unit::seeds};

  const Margin found = margin(curve);

  CHECK(found.level.estimate == 0.0);
  CHECK_FALSE(found.at_most);
  CHECK(found.level.low == 0.0);
}

TEST_CASE("a single value has a margin without an interval") {
  const Margin found = margin(curve_of({{1.0}, {0.8}}));

  CHECK(found.level.unit == Unit::none);
  CHECK(std::isnan(found.level.low));
  CHECK(margin_text(found) == "0.5");
}

TEST_CASE("where the undisturbed score is not positive there is no margin, and the reason says so") {
  CHECK(margin_text(margin(curve_of({{0.0}, {0.8}}))) == "–");
  CHECK(margin(curve_of({{0.0}, {0.8}})).reason == "the undisturbed score is not positive");
  CHECK(margin(curve_of({{1.0}, {kInfinity}})).reason == "a score is not finite");
  CHECK_FALSE(margin(curve_of({{0.0}, {0.8}})).censored);
}

TEST_CASE("a score that is NaN counts as 0") {
  const std::array values = {1.0, kNaN, 0.5, 0.5};
  CHECK(margin_scores(cell_of(values, 2)) == std::vector{0.5, 0.5});
  CHECK(margin_scores(cell_of(values, 1)) == std::vector{1.0, 0.0, 0.5, 0.5});
}

TEST_CASE("the area of one level is the score there") {
  const std::array levels = {0.0, 1.0};
  const std::array first = {1.0}, second = {-0.25};
  const std::array cells = {cell_of(first, 1), cell_of(second, 1)};
  Bootstrap bootstrap(Rng(5));

  CHECK(areas({levels, cells}) == std::vector{0.375});
  CHECK(areas({std::span(levels).first(1), std::span(cells).first(1)}) == std::vector{1.0});
  CHECK(area({levels, cells}, bootstrap).unit == Unit::none);
}

TEST_CASE("an area has the interval of a mean over seeds") {
  const std::array levels = {0.0, 1.0};
  const std::array first = {1.0, 1.0, 1.0}, second = {0.0, 0.5, 1.0};
  const std::array cells = {cell_of(first, 3), cell_of(second, 3)};
  Bootstrap bootstrap(Rng(6));

  const Interval found = area({levels, cells}, bootstrap);

  CHECK(found.estimate == doctest::Approx(0.75).epsilon(1e-15));
  CHECK(found.unit == Unit::seeds);
  CHECK(found.low < 0.7);
  CHECK(found.high > 0.8);
}

TEST_CASE("a nominal score falls short of the best below the fraction of it") {
  CHECK_FALSE(falls_short(0.9, 1.0));
  CHECK(falls_short(0.875, 1.0));
  CHECK_FALSE(falls_short(0.875, 1.0, kHalfScore));
  CHECK_FALSE(falls_short(-3.0, -1.0));
  CHECK_FALSE(falls_short(kNaN, 1.0));
}

TEST_CASE("curves that contradict themselves are refused") {
  CHECK_THROWS_AS(margin({{1.0, 1.0}, {{1.0}, {1.0}}, {1.0}, Unit::none}), Bug);
  CHECK_THROWS_AS(margin({{0.0, 1.0}, {{1.0}, {1.0, 2.0}}, {1.0}, Unit::none}), Bug);
  CHECK_THROWS_AS(margin({{-1.0}, {{1.0}}, {1.0}, Unit::none}), Bug);
  CHECK_THROWS_AS(margin({{0.0}, {{1.0, 1.0, 1.0}}, {1.0, 1.0}, Unit::none}), Bug);
}

}  // namespace
}  // namespace gust
