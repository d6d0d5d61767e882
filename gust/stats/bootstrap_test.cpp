#include "gust/stats/bootstrap.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/error.h"

namespace gust {
namespace {

using Times = Rows<const std::uint16_t>;

/// How often each unit is drawn in each resample; a row is a resample.
std::vector<std::vector<int>> all_draws(Bootstrap& bootstrap, std::span<const std::size_t> strata) {
  std::vector<std::vector<int>> draws(bootstrap.resamples());
  bootstrap.for_each_block(strata, [&](std::size_t first, const Times& times) {
    for (std::size_t k = 0; k < times.lanes; ++k) {
      for (std::size_t unit = 0; unit < times.rows; ++unit) draws[first + k].push_back(times.at(unit, k));
    }
  });
  return draws;
}

TEST_CASE("each resample draws as many units from a stratum as it has") {
  Bootstrap bootstrap(Rng(1), 1'300);  // not a multiple of the block
  const std::array<std::size_t, 3> strata = {3, 1, 5};

  const auto draws = all_draws(bootstrap, strata);

  REQUIRE(draws.size() == 1'300);
  for (const auto& times : draws) {
    REQUIRE(times.size() == 9);
    CHECK(times[0] + times[1] + times[2] == 3);
    CHECK(times[3] == 1);
    CHECK(times[4] + times[5] + times[6] + times[7] + times[8] == 5);
  }
}

TEST_CASE("all units are drawn equally often and independently") {
  constexpr std::size_t kResamples = 20'000;
  Bootstrap bootstrap(Rng(2), kResamples);
  const std::array<std::size_t, 2> strata = {7, 7};

  const auto draws = all_draws(bootstrap, strata);

  // Binomial counts: mean 1, variance 6/7, covariance -1/7 within and 0 across strata; the standard errors are below
  // 0.0075, 0.02 and 0.01, and the limits are four of them.
  for (std::size_t unit = 0; unit < 14; ++unit) {
    double sum = 0.0, squares = 0.0, with_next = 0.0, across = 0.0;
    for (const auto& times : draws) {
      sum += times[unit];
      squares += (times[unit] - 1) * (times[unit] - 1);
      with_next += (times[unit] - 1) * (times[unit % 7 == 6 ? unit - 6 : unit + 1] - 1);
      across += (times[unit] - 1) * (times[(unit + 7) % 14] - 1);
    }
    CHECK(sum / kResamples == doctest::Approx(1.0).epsilon(0.03));
    CHECK(std::abs(squares / kResamples - 6.0 / 7.0) < 0.08);
    CHECK(std::abs(with_next / kResamples + 1.0 / 7.0) < 0.04);
    CHECK(std::abs(across / kResamples) < 0.04);
  }
}

TEST_CASE("draws depend on the seed and the strata, not on earlier questions or on what is kept") {
  Bootstrap fresh(Rng(3), 1'000);
  Bootstrap used(Rng(3), 1'000);
  Bootstrap other(Rng(4), 1'000);
  const std::array<std::size_t, 2> strata = {4, 6};

  for (std::size_t size = 1; size < 60; ++size) all_draws(used, std::span(&size, 1));  // more shapes than are kept

  CHECK(all_draws(used, strata) == all_draws(fresh, strata));
  CHECK(all_draws(used, strata) == all_draws(used, strata));
  CHECK(all_draws(other, strata) != all_draws(fresh, strata));
}

TEST_CASE("more units than 16 bits can count are drawn, in blocks of any size alike") {
  const std::size_t units = 599'186;  // as many episodes as a study may have
  std::vector<std::vector<int>> draws[2];
  for (const std::size_t more : {0, 1}) {  // blocks of 16 resamples
    Bootstrap bootstrap(Rng(6), 3 + 14 * more);
    draws[more] = all_draws(bootstrap, std::span(&units, 1));
  }

  for (std::size_t k = 0; k < 3; ++k) CHECK(draws[0][k] == draws[1][k]);
  for (const auto& times : draws[1]) {
    std::size_t sum = 0, none = 0;
    for (const int count : times) {
      sum += static_cast<std::size_t>(count);
      none += count == 0 ? 1 : 0;
    }
    CHECK(sum == units);
    CHECK(static_cast<double>(none) / units == doctest::Approx(0.36788).epsilon(0.05));  // 1 / e, of 8094 groups
  }
}

TEST_CASE("of very many units neighbours are drawn together, and a mean spreads as it would by single units") {
  const std::size_t strata[] = {100'003, 8'192};  // 7692 groups of 13 and 7 units left over; single units
  Bootstrap bootstrap(Rng(7), 1'000);
  std::vector<double> means;
  bool together = true, alone = false;

  bootstrap.for_each_block(strata, [&](std::size_t, const Times& times) {
    for (std::size_t k = 0; k < times.lanes; ++k) {
      double sum = 0;
      for (std::size_t i = 0; i < strata[0]; ++i) sum += times.at(i, k) * Rng(8).uniform(i);
      means.push_back(sum / static_cast<double>(strata[0]));
      together = together && times.at(13, k) == times.at(25, k) && times.at(100'002, k) == 1;
      alone = alone || times.at(strata[0], k) != times.at(strata[0] + 1, k);
    }
  });

  double mean = 0, squares = 0;
  for (const double value : means) mean += value / static_cast<double>(means.size());
  for (const double value : means) squares += (value - mean) * (value - mean);
  CHECK(together);
  CHECK(alone);
  // sqrt(1 / 12 / 100,003), whose estimate from 1000 resamples has a standard error of 2.2 %, and four of them
  CHECK(std::sqrt(squares / 1000.0) == doctest::Approx(0.00091286).epsilon(0.09));
}

TEST_CASE("a stratum is drawn alike whatever follows it, and in shapes too large to keep") {
  Bootstrap bootstrap(Rng(5), 1'000);
  const std::array<std::size_t, 1> small = {10};
  const std::array<std::size_t, 2> large = {10, 2'000};

  const auto alone = all_draws(bootstrap, small);
  const auto first = all_draws(bootstrap, large);

  for (std::size_t k = 0; k < alone.size(); ++k) {
    CHECK(std::vector<int>(first[k].begin(), first[k].begin() + 10) == alone[k]);
  }
}

TEST_CASE("bounds are the percentiles of what the resamples gave, infinite where those are") {
  const Bootstrap bootstrap(Rng(6), 1'000, 0.8);
  std::vector<double> resampled = {10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0};
  Interval interval;

  bootstrap.bound(interval, resampled);

  CHECK(interval.low == doctest::Approx(1.0).epsilon(1e-15));
  CHECK(interval.high == doctest::Approx(9.0).epsilon(1e-15));

  resampled = {1, 2, 3, 4, std::numeric_limits<double>::infinity()};
  bootstrap.bound(interval, resampled);

  CHECK(interval.low == doctest::Approx(1.4).epsilon(1e-15));
  CHECK(interval.high == std::numeric_limits<double>::infinity());
}

TEST_CASE("a bootstrap without resamples or with an impossible confidence is refused") {
  CHECK_THROWS_AS(Bootstrap(Rng(1), 0), Bug);
  CHECK_THROWS_AS(Bootstrap(Rng(1), 100, 1.0), Bug);
  CHECK_THROWS_AS(Bootstrap(Rng(1), 100, 0.0), Bug);
}

}  // namespace
}  // namespace gust
