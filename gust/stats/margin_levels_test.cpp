#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "gust/core/rng.h"
#include "gust/stats/margin.h"

// Margins of a test plant whose score along the level is known exactly.

namespace gust {
namespace {

using Shape = double (*)(double level);

double linear(double level) { return std::max(0.0, 1.0 - 0.05 * level); }
double step(double level) { return level < 2.0 ? 1.0 : 0.2; }
double bump(double level) { return level < 1.0 ? 1.0 + 0.2 * level : std::max(0.0, 1.2 - 0.1 * (level - 1.0)); }
double plateau(double level) {
  if (level < 1.0) return 1.0 - 0.06 * level;
  return level < 3.0 ? 0.94 : std::max(0.0, 0.94 - 0.04 * (level - 3.0));
}
/// Falls, recovers, and falls again: the first crossing, at 0.5, is the margin.
double twice(double level) {
  if (level < 1.0) return 1.0 - 0.2 * level;
  return level < 2.0 ? 0.8 + 0.2 * (level - 1.0) : std::max(0.0, 1.0 - 0.2 * (level - 2.0));
}

struct Case {
  const char* name;
  Shape shape;
  double margin;
};
constexpr std::array kCases = {Case{"linear", linear, 2.0}, Case{"step", step, 2.0}, Case{"bump", bump, 4.0},
                               Case{"plateau", plateau, 4.0}, Case{"twice", twice, 0.5}};

/// How one seed's score differs from the shape.
struct Seed {
  double quality = 0;      ///< added at every level
  double sensitivity = 1;  ///< multiplies the level
};

std::vector<double> scores_at(Shape shape, double level, const std::vector<Seed>& seeds) {
  std::vector<double> scores;
  for (const Seed& seed : seeds) scores.push_back(shape(level * seed.sensitivity) + seed.quality);
  return scores;
}

/// Refines until nothing is left to look at.
MarginCurve refined(Shape shape, const std::vector<Seed>& seeds, const std::vector<double>& levels) {
  MarginCurve curve{.undisturbed = scores_at(shape, 0, seeds), .unit = Unit::seeds};
  for (const double level : levels) curve.add(level, scores_at(shape, level, seeds));
  for (int round = 0;; ++round) {
    REQUIRE(round < 30);
    const std::vector<double> more = next_margin_levels(curve, {}, 0.02);
    if (more.empty()) return curve;
    for (const double level : more) curve.add(level, scores_at(shape, level, seeds));
  }
}

TEST_CASE("the margin of a known curve is the true one from any grid") {
  const std::vector<std::vector<double>> grids = {
      {0, 60}, {0, 15, 30, 45, 60}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, {30, 60}, {0.3, 0.6, 2.5, 10}};
  for (const Case& one : kCases) {
    for (const auto& grid : grids) {
      CAPTURE(one.name);
      CAPTURE(grid.size());
      const Margin found = margin(refined(one.shape, {{}}, grid));
      CHECK(std::abs(found.level.estimate - one.margin) <= 0.02 * one.margin);
      CHECK_FALSE(found.censored);
    }
  }
}

TEST_CASE("neighbours around the margin and the ends of its interval are within the tolerance") {
  const std::vector<Seed> seeds = {{0, 0.9}, {0.01, 1}, {-0.01, 1.2}, {0, 1.1}, {0.02, 0.8}};
  const MarginCurve curve = refined(linear, seeds, {0, 20});
  const MarginBands bands = margin_bands(curve, {});
  const double found = margin(curve).level.estimate;

  for (const std::vector<double>* band : {&bands.low, &bands.value, &bands.high}) {
    const auto at = std::ranges::find_if(*band, [](double v) { return v < 0; }) - band->begin();
    REQUIRE(at > 0);
    CHECK(curve.levels[at] - curve.levels[at - 1] <= 0.02 * found);
  }
  for (std::size_t i = 2; i < curve.levels.size() && curve.levels[i] <= found; ++i)
    CHECK(curve.levels[i] <= 1.25 * curve.levels[i - 1]);
}

TEST_CASE("a crossing below all levels is looked for down to a millionth of the last") {
  const auto tiny = [](double level) { return level < 1e-4 ? 1.0 : 0.5; };
  CHECK(margin(refined(tiny, {{}}, {0, 1, 2})).level.estimate == doctest::Approx(1e-4).epsilon(0.02));

  const auto at_once = [](double level) { return level > 0 ? 0.5 : 1.0; };
  MarginCurve curve = refined(at_once, {{}}, {0, 1, 2});
  CHECK(margin(curve).level.estimate <= 2e-6);
}

TEST_CASE("where nothing falls the levels below the last are scanned and the margin is at least the last") {
  const auto flat = [](double) { return 1.0; };
  const MarginCurve curve = refined(flat, {{}}, {0, 60});
  CHECK(margin(curve).censored);
  CHECK(curve.levels.size() > 15);

  const auto dip = [](double level) { return level > 10 && level < 14 ? 0.5 : 1.0; };
  CHECK(margin(refined(dip, {{}}, {0, 60})).level.estimate == doctest::Approx(10).epsilon(0.02));
}

/// Of 1000 sets of seeds, in how many the interval of the margin holds the true one: that of the mean over 20,000
/// seeds.
int covered(Shape shape, double quality, double sensitivity, std::size_t count) {
  const auto draw = [&](std::size_t size, Rng rng) {
    std::vector<Seed> seeds;
    for (std::size_t i = 0; i < size; ++i)
      seeds.push_back({quality * rng.normal(2 * i), std::max(0.1, 1 + sensitivity * rng.normal(2 * i + 1))});
    return seeds;
  };
  const double truth = margin(refined(shape, draw(20'000, Rng(99)), {0, 5, 10, 20})).level.estimate;
  int within = 0;
  for (std::uint64_t set = 0; set < 1000; ++set) {
    const Margin found = margin(refined(shape, draw(count, Rng(7).split(count).split(set)), {0, 5, 10, 20}));
    within += found.level.low <= truth && truth <= found.level.high ? 1 : 0;
  }
  return within;
}

TEST_CASE("the interval of a margin covers the true one in 95 % of sets of seeds") {
  for (const Case& one : kCases) {
    for (const std::size_t seeds : {std::size_t{5}, std::size_t{10}, std::size_t{30}}) {
      CAPTURE(one.name);
      CAPTURE(seeds);
      const int sensitive = covered(one.shape, 0.0, 0.2, seeds);
      CHECK(sensitive >= 930);
      // Seeds that fall at once at levels of their own: the bound on when the first of them falls is a cautious one.
      CHECK(sensitive <= (one.shape == step ? 990 : 970));
      // Where the interval is no wider than the steps between levels it covers more: it reaches out to the levels.
      CHECK(covered(one.shape, 0.03, 0.0, seeds) >= 930);
      CHECK(covered(one.shape, 0.02, 0.1, seeds) >= 930);
    }
  }
}

TEST_CASE("a t-test alone would cover too little where units fall one by one") {
  // Five seeds that fall at 1, 1.2, 1.5, 1.6 and 2: below 1 all of them hold, and their spread there is 0.
  MarginCurve curve{.undisturbed = {1, 1, 1, 1, 1}, .unit = Unit::seeds};
  const std::vector<double> falls = {1.0, 1.2, 1.5, 1.6, 2.0};
  for (double level = 0; level < 2.5; level += 0.01) {
    std::vector<double> scores;
    for (const double fall : falls) scores.push_back(level < fall ? 1.0 : 0.0);
    curve.add(level, scores);
  }

  // scipy.stats.nct.ppf(0.975, 4, 0.8416 sqrt(5)) / sqrt(5) is 3.0584, the tolerance factor of the lowest fifth; of the
  // levels' logarithms the mean is 0.35019 and the deviation 0.26732: exp(0.35019 - 3.0584 * 0.26732) is 0.62663.
  CHECK(falling_bound(curve, {}) == doctest::Approx(0.62663).epsilon(0.01));
  CHECK(margin(curve).level.low <= 0.63);
  CHECK(margin_bands(curve, {}).low[90] > 0);  // at 0.9 a t-test is certain
  CHECK(margin(curve).level.estimate == doctest::Approx(1.0).epsilon(0.011));
}

}  // namespace
}  // namespace gust
