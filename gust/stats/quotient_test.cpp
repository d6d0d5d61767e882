#include "gust/stats/quotient.h"

#include <doctest/doctest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "gust/stats/aggregate.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

TEST_CASE("the mean of a row is the quotient of the means, not the mean of quotients") {
  const std::vector<double> returns = {3, 1, 8, 8}, lengths = {4, 2, 8, 16};

  const Matrix<double> values = quotient_values(cell_of(returns, 2), cell_of(lengths, 2));

  CHECK(mean(values.row(0)) == doctest::Approx(4.0 / 6).epsilon(1e-15));  // the mean of quotients is 5/8
  CHECK(mean(values.row(1)) == doctest::Approx(16.0 / 24).epsilon(1e-15));
  CHECK(values.at(0, 0) == doctest::Approx(7.0 / 9).epsilon(1e-15));
  CHECK(values.at(0, 1) == doctest::Approx(5.0 / 9).epsilon(1e-15));
}

TEST_CASE("episodes that are all alike give their own quotient, and one that is not a number gives none") {
  const std::vector<double> returns(5, 0.3), lengths(5, 7.0);
  std::vector<double> broken = returns;
  broken[3] = std::nan("");

  const Matrix<double> values = quotient_values(cell_of(returns, 1), cell_of(lengths, 1));

  for (const double value : values.row(0)) CHECK(value == 0.3 / 7.0);
  CHECK(std::isnan(mean(quotient_values(cell_of(broken, 1), cell_of(lengths, 1)).row(0))));
}

/// The percentiles of mean(returns) / mean(lengths) over episodes that are drawn together.
Interval exact_interval(std::span<const double> returns, std::span<const double> lengths, Bootstrap& bootstrap) {
  const std::size_t strata[] = {returns.size()};
  std::vector<double> resampled(bootstrap.resamples());
  bootstrap.for_each_block(strata, [&](std::size_t first, const Rows<const std::uint16_t>& times) {
    for (std::size_t k = 0; k < times.lanes; ++k) {
      double numerator = 0, denominator = 0;
      for (std::size_t e = 0; e < returns.size(); ++e) {
        numerator += times.at(e, k) * returns[e];
        denominator += times.at(e, k) * lengths[e];
      }
      resampled[first + k] = numerator / denominator;
    }
  });
  Interval result;
  bootstrap.bound(result, resampled);
  return result;
}

TEST_CASE("resampled over episodes, return and length are drawn together") {
  // 25 episodes of which some fail early, as under strong noise: lengths from 50 to 250, returns that go with them.
  constexpr std::size_t kEpisodes = 25;
  std::vector<double> returns, lengths;
  for (std::size_t e = 0; e < kEpisodes; ++e) {
    lengths.push_back(std::round(50 + 200 * Rng(1).uniform(e)));
    returns.push_back(lengths.back() * (0.4 + 0.1 * Rng(2).uniform(e)));
  }
  Bootstrap bootstrap(Rng(3));
  const Matrix<double> values = quotient_values(cell_of(returns, 1), cell_of(lengths, 1));

  const Interval found = interval(std::as_const(values).view(), Statistic::mean, bootstrap);

  // Deviations of the mean length (6 % here) enter the ends once more, multiplied by those of the quotient.
  const Interval exact = exact_interval(returns, lengths, bootstrap);
  const double width = exact.high - exact.low;
  CHECK(std::abs(found.low - exact.low) < 0.06 * width);
  CHECK(std::abs(found.high - exact.high) < 0.06 * width);
  // Drawn apart, returns would vary with the lengths: the interval would be ten times as wide.
  const Interval apart = interval(cell_of(returns, 1), Statistic::mean, bootstrap);
  CHECK((apart.high - apart.low) / mean(lengths) > 5 * width);
}

}  // namespace
}  // namespace gust
