// What SciPy, NumPy and rliable said about the same samples: tests/reference/statistics, with the script that asked
// them.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "gust/stats/aggregate.h"
#include "gust/stats/compare.h"
#include "gust/stats/margin.h"
#include "gust/stats/rank_correlation.h"
#include "gust/stats/share.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

using Json = nlohmann::json;
using Scores = std::vector<std::vector<double>>;

constexpr std::size_t kResamples = 100'000;

Json reference(const char* part) {
  std::ifstream file(GUST_TEST_DATA "/reference/statistics/statistics.json");
  REQUIRE(file.good());
  return Json::parse(file).at(part);
}

std::vector<double> numbers(const Json& json) { return json.get<std::vector<double>>(); }

/// Equal but for the last roundings of sums.
bool equal(double ours, double theirs) { return std::abs(ours - theirs) <= 1e-12 * std::max(1.0, std::abs(theirs)); }

/// A row of a table is a task, with one value a seed.
std::vector<Cell> tasks_of(const Scores& scores) {
  std::vector<Cell> tasks;
  for (const auto& row : scores) tasks.push_back(cell_of(row, row.size()));
  return tasks;
}

/// A table as one cell: a row is a seed, with one value an episode.
Matrix<double> cell_values(const Json& json) {
  const auto table = json.get<Scores>();
  Matrix<double> values(table.size(), table.front().size());
  for (std::size_t row = 0; row < table.size(); ++row) {
    std::copy(table[row].begin(), table[row].end(), values.row(row).begin());
  }
  return values;
}

/// Whether a bound lies where 100,000 resamples may put it: between the reference's percentiles four standard errors to
/// either side. The last roundings come on top, for a bound of many equal resamples.
bool within(double bound, const Json& band) {
  const double slack = 1e-12;
  return bound >= band[0].get<double>() - slack && bound <= band[1].get<double>() + slack;
}

void check_interval(const Interval& ours, const Json& theirs) {
  CHECK(equal(ours.estimate, theirs.at("estimate")));
  CHECK(within(ours.low, theirs.at("low_band")));
  CHECK(within(ours.high, theirs.at("high_band")));
}

TEST_CASE("statistics agree with NumPy, SciPy and rliable") {
  const Json statistics = reference("statistics");
  for (const auto& [name, theirs] : statistics.items()) {
    CAPTURE(name);
    const auto values = numbers(theirs.at("values"));

    CHECK(equal(mean(values), theirs.at("mean")));
    CHECK(equal(median(values), theirs.at("median")));
    CHECK(equal(iqm(values), theirs.at("iqm")));
    CHECK(equal(iqm(values), theirs.at("trim_mean")));
    CHECK(equal(optimality_gap(values), theirs.at("optimality_gap")));
    CHECK(equal(optimality_gap(values, 0.5), theirs.at("optimality_gap_half")));
    if (theirs.at("sample_deviation").is_null()) {
      CHECK(std::isnan(sample_deviation(values)));
    } else {
      CHECK(equal(sample_deviation(values), theirs.at("sample_deviation")));
    }
    const auto shares = numbers(theirs.at("shares"));
    const auto quantiles = numbers(theirs.at("quantiles"));
    for (std::size_t i = 0; i < shares.size(); ++i) CHECK(equal(quantile(values, shares[i]), quantiles[i]));
  }
}

TEST_CASE("correlations agree with SciPy, ties included") {
  for (const Json& row : reference("correlations")) {
    const std::vector<double> x = numbers(row["x"]), y = numbers(row["y"]), expected = numbers(row["r_rho_tau"]);
    CHECK(equal(pearson(x, y), expected[0]));
    CHECK(equal(spearman(x, y), expected[1]));
    CHECK(equal(kendall(x, y), expected[2]));
  }
}

TEST_CASE("Wilson's interval agrees with SciPy") {
  for (const Json& row : reference("wilson")) {
    CAPTURE(row.dump());
    const Interval ours = wilson(row[0], row[1], row[2]);

    CHECK(equal(ours.low, row[3]));
    CHECK(equal(ours.high, row[4]));
  }
}

TEST_CASE("the probability of improvement agrees with rliable and SciPy's Mann-Whitney statistic") {
  for (const Json& row : reference("improvement")) {
    CHECK(equal(probability_of_improvement(numbers(row.at("x")), numbers(row.at("y"))), row.at("p")));
  }
}

TEST_CASE("stratified bootstrap intervals agree with rliable") {
  Bootstrap bootstrap(Rng(1), kResamples);
  for (const Json& row : reference("aggregates")) {
    const auto scores = row.at("scores").get<Scores>();
    const auto tasks = tasks_of(scores);
    CAPTURE(tasks.size());

    check_interval(interval(tasks, Statistic::mean, bootstrap), row.at("mean"));
    check_interval(interval(tasks, Statistic::iqm, bootstrap), row.at("iqm"));
    check_interval(interval(tasks, Statistic::median, bootstrap), row.at("median"));
    check_interval(optimality_gap_interval(tasks, 0.8, bootstrap), row.at("optimality_gap"));
    check_interval(interval(tasks, StatisticFunction(sample_deviation), bootstrap), row.at("sample_deviation"));
  }
}

TEST_CASE("the performance profile and its band agree with rliable") {
  Bootstrap bootstrap(Rng(2), kResamples);
  const Json theirs = reference("profile");
  const auto scores = theirs.at("scores").get<Scores>();

  const auto ours = performance_profile(tasks_of(scores), numbers(theirs.at("thresholds")), bootstrap);

  REQUIRE(ours.size() == theirs.at("profile").size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    // Shares of 120 runs: a percentile may fall on the next share.
    CHECK(equal(ours[i].estimate, theirs.at("profile")[i]));
    CHECK(std::abs(ours[i].low - theirs.at("low")[i].get<double>()) <= 1.001 / 120);
    CHECK(std::abs(ours[i].high - theirs.at("high")[i].get<double>()) <= 1.001 / 120);
  }
}

TEST_CASE("intervals of the probability of improvement agree with rliable") {
  Bootstrap bootstrap(Rng(3), kResamples);
  for (const Json& row : reference("improvement_intervals")) {
    const auto x = row.at("x").get<Scores>();
    const auto y = row.at("y").get<Scores>();

    check_interval(probability_of_improvement(tasks_of(x), tasks_of(y), bootstrap), row);
  }
}

TEST_CASE("intervals of differences are those of SciPy's t tests: paired episodes, and seeds") {
  const std::array levels = {0.0};
  const Json differences = reference("differences");
  for (const auto& [name, row] : differences.items()) {
    CAPTURE(name);
    const auto a = cell_values(row.at("a"));
    const auto b = cell_values(row.at("b"));
    const std::array<Cell, 1> cell_a = {a.view()}, cell_b = {b.view()};

    const PairedDifference ours = compare({levels, cell_a}, {levels, cell_b}, Rng(4)).scores.front();

    const double low = row.at("low"), high = row.at("high");
    const double tolerance = 0.1 * (high - low);  // 2000 resamples; and seeds have Satterthwaite's degrees of freedom
    CHECK(equal(ours.interval.estimate, row.at("estimate")));
    CHECK(std::abs(ours.interval.low - low) < tolerance);
    CHECK(std::abs(ours.interval.high - high) < tolerance);
    CHECK(ours.unit == (name == "paired episodes" ? Unit::episodes : Unit::seeds));
  }
}

TEST_CASE("margins and areas agree with roots, t-tests and integrals of SciPy") {
  const Json margins = reference("margins");
  for (const auto& [name, row] : margins.items()) {
    CAPTURE(name);
    const auto levels = numbers(row.at("levels"));
    const auto by_seed = row.at("scores").get<Scores>();
    MarginCurve curve{.unit = Unit::seeds};
    std::vector<std::vector<double>> by_level(levels.size());
    for (std::size_t level = 0; level < levels.size(); ++level) {
      for (const auto& seed : by_seed) by_level[level].push_back(seed[level]);
      curve.add(levels[level], by_level[level]);
    }
    curve.undisturbed = by_level.front();
    const auto cells = tasks_of(by_level);

    const Margin ours = margin(curve);

    // What lies beyond the grid stands as 1e300 there. Ours says: an estimate at least the last level.
    const double theirs = row.at("margin");
    CHECK(ours.censored == (theirs == 1e300));
    CHECK(equal(ours.level.estimate, std::min(theirs, levels.back())));
    CHECK(ours.level.low == row.at("student_low").get<double>());
    const double high = row.at("student_high");
    CHECK(ours.level.high == (high == 1e300 ? std::numeric_limits<double>::infinity() : high));
    const auto our_areas = areas({levels, cells});
    for (std::size_t seed = 0; seed < by_seed.size(); ++seed) CHECK(equal(our_areas[seed], row.at("areas")[seed]));
  }
}

}  // namespace
}  // namespace gust
