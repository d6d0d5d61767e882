#include "gust/stats/aggregate.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/stats/statistics.h"

namespace gust {
namespace {

TEST_CASE("8.8.4 the bootstrap of equal values has no width") {
  Bootstrap bootstrap(Rng(1));
  const std::vector<double> values(10, 0.1);  // ten tenths do not add up to one in binary

  for (const Statistic statistic : {Statistic::mean, Statistic::median, Statistic::iqm}) {
    const Interval found = interval(cell_of(values, 10), statistic, bootstrap);

    CHECK(found.estimate == 0.1);
    CHECK(found.low == 0.1);
    CHECK(found.high == 0.1);
    CHECK(found.unit == Unit::seeds);
    CHECK(found.n == 10);
  }
}

/// How often the interval of the mean of normal values covers it.
double coverage(std::size_t count, double confidence) {
  constexpr std::size_t kTrials = 2'000;
  Bootstrap bootstrap(Rng(2), 10'000, confidence);
  const Rng normal = Rng(3).split("coverage");
  std::size_t covered = 0;
  std::vector<double> values(count);
  for (std::size_t trial = 0; trial < kTrials; ++trial) {
    for (std::size_t i = 0; i < count; ++i) values[i] = normal.normal(trial * count + i);
    const Interval found = interval(cell_of(values, count), Statistic::mean, bootstrap);
    covered += found.low <= 0.0 && 0.0 <= found.high ? 1 : 0;
  }
  return static_cast<double>(covered) / kTrials;
}

TEST_CASE("8.8.4 intervals of the mean of ten normal values cover it in 88 to 96 of 100 trials") {
  const double covered = coverage(10, 0.95);
  CHECK(covered >= 0.88);
  CHECK(covered <= 0.96);
}

TEST_CASE("intervals of few values cover less than they say, and widened ones nearly what they say") {
  const auto widened = [](std::size_t count) { return coverage(count, 1.0 - 2.0 * widened_tail(count)); };
  CHECK(coverage(5, 0.95) < 0.87);
  CHECK(widened(5) > 0.91);  // never more than 1 - 2 / 2^5: all five may lie on one side of the mean
  CHECK(widened(5) < 0.9375);
  CHECK(widened(10) > 0.93);
  CHECK(widened(10) < 0.96);
}

TEST_CASE("the tail of widened intervals shrinks to the nominal one as units get many") {
  // SciPy: norm.cdf(-sqrt(n / (n - 1)) * t.ppf(0.975, n - 1))
  CHECK(widened_tail(5) == doctest::Approx(0.0009541005518824907).epsilon(1e-12));
  CHECK(widened_tail(10) == doctest::Approx(0.008550639024406366).epsilon(1e-12));
  CHECK(widened_tail(1'000'000) == doctest::Approx(0.02499980407755414).epsilon(1e-9));
}

TEST_CASE("episodes are averaged within their seed before anything else") {
  Bootstrap bootstrap(Rng(4));
  const std::vector<double> nested = {0.0, 2.0, 3.0, 5.0, -8.0, 8.0};  // three seeds of two episodes
  const std::vector<double> averaged = {1.0, 4.0, 0.0};

  const Interval of_nested = interval(cell_of(nested, 3), Statistic::median, bootstrap);
  const Interval of_averaged = interval(cell_of(averaged, 3), Statistic::median, bootstrap);

  CHECK(of_nested.estimate == 1.0);
  CHECK(of_nested.low == of_averaged.low);
  CHECK(of_nested.high == of_averaged.high);
  CHECK(of_nested.n == 3);
}

TEST_CASE("three seeds give an interval from the least to the greatest") {
  Bootstrap bootstrap(Rng(5));
  const std::vector<double> values = {0.25, -1.0, 7.0};

  const Interval found = interval(cell_of(values, 3), Statistic::mean, bootstrap);

  // All three draws fall on the same seed in 1 of 27 resamples, which is more than 2.5 of 100.
  CHECK(found.low == -1.0);
  CHECK(found.high == 7.0);
}

TEST_CASE("a single seed gives an interval over episodes, which says so") {
  Bootstrap bootstrap(Rng(6));
  const std::vector<double> episodes = {1.0, 2.0, 3.0, 4.0, 10.0};

  const Interval found = interval(cell_of(episodes, 1), Statistic::mean, bootstrap);
  const Interval iqm_found = interval(cell_of(episodes, 1), Statistic::iqm, bootstrap);

  CHECK(found.unit == Unit::episodes);
  CHECK(found.n == 5);
  CHECK(found.estimate == 4.0);
  CHECK(found.low < 4.0);
  CHECK(found.high > 4.0);
  CHECK(iqm_found.estimate == 4.0);  // the statistic is of seeds, and there is one
  CHECK(iqm_found.high == found.high);
}

TEST_CASE("a single value has no interval") {
  Bootstrap bootstrap(Rng(7));
  const std::vector<double> value = {0.5};

  const Interval found = interval(cell_of(value, 1), Statistic::mean, bootstrap);

  CHECK(found.estimate == 0.5);
  CHECK(std::isnan(found.low));
  CHECK(std::isnan(found.high));
  CHECK(found.unit == Unit::none);
  CHECK(found.n == 1);
}

TEST_CASE("a value that is not finite leaves the estimate to arithmetic and gives no interval") {
  Bootstrap bootstrap(Rng(8));
  const std::vector<double> with_nan = {1.0, std::numeric_limits<double>::quiet_NaN(), 2.0, 3.0};
  const std::vector<double> with_infinity = {1.0, std::numeric_limits<double>::infinity(), 2.0, 3.0};

  for (const std::size_t seeds : {std::size_t{1}, std::size_t{4}}) {
    const Interval nan_found = interval(cell_of(with_nan, seeds), Statistic::mean, bootstrap);
    const Interval infinite = interval(cell_of(with_infinity, seeds), Statistic::mean, bootstrap);

    CHECK(std::isnan(nan_found.estimate));
    CHECK(std::isnan(nan_found.low));
    CHECK(infinite.estimate == std::numeric_limits<double>::infinity());
    CHECK(std::isnan(infinite.high));
  }
}

TEST_CASE("a single seed's tasks are resampled by their episodes, each task by itself") {
  Bootstrap bootstrap(Rng(9));
  const std::vector<double> easy = {0.5, 0.5, 0.5};
  const std::vector<double> hard = {0.0, 1.0, 0.5};
  const std::array tasks = {cell_of(easy, 1), cell_of(hard, 1)};

  const Interval found = interval(tasks, Statistic::mean, bootstrap);

  // Three draws of the hard task are all 0 or all 1 in 1 of 27 resamples; the easy one does not move.
  CHECK(found.unit == Unit::episodes);
  CHECK(found.estimate == 0.5);
  CHECK(found.low == 0.25);
  CHECK(found.high == 0.75);
}

TEST_CASE("a task with one seed beside others with more is held fixed") {
  Bootstrap bootstrap(Rng(10));
  const std::vector<double> fixed = {6.0};
  const std::vector<double> varying = {0.0, 3.0};
  const std::array tasks = {cell_of(fixed, 1), cell_of(varying, 2)};

  const Interval found = interval(tasks, Statistic::mean, bootstrap);

  CHECK(found.estimate == 3.0);
  CHECK(found.low == 2.0);
  CHECK(found.high == 4.0);
  CHECK(found.n == 2);
}

TEST_CASE("any statistic can be bootstrapped, and agrees with the fast way where there is one") {
  Bootstrap bootstrap(Rng(11));
  const std::vector<double> left = {1.0, 4.0, 2.0, 8.0, 5.0};
  const std::vector<double> right = {3.0, 0.0, 7.0, 7.0, 1.0};
  const std::array seeds = {cell_of(left, 5), cell_of(right, 5)};
  const std::array episodes = {cell_of(left, 1), cell_of(right, 1)};

  for (const auto& tasks : {seeds, episodes}) {
    const Interval fast = interval(tasks, Statistic::iqm, bootstrap);
    const Interval general = interval(
        tasks, [](std::span<const double> values) { return iqm(values); }, bootstrap);

    // The sums differ in order: a few roundings of numbers below ten.
    CHECK(general.estimate == doctest::Approx(fast.estimate).epsilon(1e-14));
    CHECK(general.low == doctest::Approx(fast.low).epsilon(1e-14));
    CHECK(general.high == doctest::Approx(fast.high).epsilon(1e-14));
  }
}

TEST_CASE("the interval of very many episodes is that of the normal distribution, as it would be of single ones") {
  Bootstrap bootstrap(Rng(14), 2'000);
  std::vector<double> values;
  for (std::uint64_t i = 0; i < 100'003; ++i) values.push_back(5.0 + Rng(15).normal(i));  // 13 a group, 7 left over
  double sum = 0;
  for (const double value : values) sum += value;

  const Interval found = interval(cell_of(values, 1), Statistic::mean, bootstrap);

  CHECK(found.estimate == doctest::Approx(sum / 100'003).epsilon(1e-12));  // the plain sum rounds 100,003 times
  CHECK(found.n == 100'003);
  CHECK(found.unit == Unit::episodes);
  // 1.96 / sqrt(100,003); a percentile of 2000 resamples has a standard error of 3 % of that, and four of them
  CHECK(found.high - found.estimate == doctest::Approx(0.0061979).epsilon(0.12));
  CHECK(found.estimate - found.low == doctest::Approx(0.0061979).epsilon(0.12));
}

TEST_CASE("the performance profile is the share of runs above each threshold") {
  Bootstrap bootstrap(Rng(12));
  const std::vector<double> values = {0.1, 0.4, 0.4, 0.9};

  const auto profile = performance_profile(std::array{cell_of(values, 4)}, std::array{0.0, 0.4, 1.0}, bootstrap);

  REQUIRE(profile.size() == 3);
  CHECK(profile[0].estimate == 1.0);
  CHECK(profile[0].low == 1.0);
  CHECK(profile[1].estimate == 0.25);
  CHECK(profile[1].low == 0.0);
  CHECK(profile[1].high == 0.75);
  CHECK(profile[2].estimate == 0.0);
  CHECK(profile[2].high == 0.0);
}

TEST_CASE("intervals do not depend on what was asked before") {
  Bootstrap fresh(Rng(13));
  Bootstrap used(Rng(13));
  const std::vector<double> values = {1.0, 4.0, 2.0, 8.0, 5.0, 7.0};

  interval(cell_of(values, 3), Statistic::mean, used);
  interval(cell_of(values, 1), Statistic::mean, used);
  const Interval later = interval(cell_of(values, 6), Statistic::iqm, used);
  const Interval first = interval(cell_of(values, 6), Statistic::iqm, fresh);

  CHECK(later.low == first.low);
  CHECK(later.high == first.high);
}

}  // namespace
}  // namespace gust
