#include "gust/stats/share.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/error.h"
#include "gust/stats/aggregate.h"

namespace gust {
namespace {

TEST_CASE("Wilson's interval keeps its width where all survive or none does") {
  const Interval all = wilson(25, 25);
  const Interval none = wilson(0, 25);

  // The far bound is z^2 / (n + z^2) with z^2 = 3.841459.
  CHECK(all.high == 1.0);
  CHECK(all.low == doctest::Approx(1.0 - 3.841458820694124 / 28.841458820694124).epsilon(1e-14));
  CHECK(none.low == 0.0);
  CHECK(none.high == doctest::Approx(1.0 - all.low).epsilon(1e-14));
  CHECK(all.unit == Unit::episodes);
  CHECK(all.n == 25);
}

TEST_CASE("survival of one seed is Wilson's interval over its episodes") {
  Bootstrap bootstrap(Rng(1));
  const std::vector<double> survived = {1, 1, 0, 1, 1, 1, 1, 1};

  const Interval found = share_interval(cell_of(survived, 1), bootstrap);

  CHECK(found.estimate == 0.875);
  CHECK(found.low == wilson(7, 8).low);
  CHECK(found.high == wilson(7, 8).high);
  CHECK(found.unit == Unit::episodes);
}

TEST_CASE("survival of seeds that differ is as wide as the bootstrap over seeds") {
  Bootstrap bootstrap(Rng(2));
  std::vector<double> survived(100, 1.0);  // four seeds of 25 episodes, one of which always fails
  for (std::size_t i = 0; i < 25; ++i) survived[i] = 0.0;

  const Interval found = share_interval(cell_of(survived, 4), bootstrap);
  const Interval seeds = interval(cell_of(survived, 4), Statistic::mean, bootstrap);

  CHECK(found.estimate == 0.75);
  CHECK(found.low == seeds.low);
  CHECK(found.low < wilson(75, 100).low);
  CHECK(found.high == 1.0);
  CHECK(found.unit == Unit::seeds);
  CHECK(found.n == 4);
}

TEST_CASE("survival of seeds that all survive is as wide as Wilson's interval") {
  Bootstrap bootstrap(Rng(3));
  const std::vector<double> survived(250, 1.0);

  const Interval found = share_interval(cell_of(survived, 10), bootstrap);

  CHECK(found.low == wilson(250, 250).low);
  CHECK(found.high == 1.0);
  CHECK(found.n == 10);
}

TEST_CASE("an episode whose survival is NaN has failed") {
  Bootstrap bootstrap(Rng(4));
  const std::vector<double> survived = {1.0, std::numeric_limits<double>::quiet_NaN()};

  CHECK(share_interval(cell_of(survived, 1), bootstrap).estimate == 0.5);
  CHECK(share_interval(cell_of(survived, 2), bootstrap).estimate == 0.5);
}

TEST_CASE("a proportion of no trials is refused") {
  CHECK_THROWS_AS(wilson(0, 0), Bug);
  CHECK_THROWS_AS(wilson(2, 1), Bug);
}

/// The probability that Wilson's interval of n trials with this chance of success lies above a bound.
double decided(std::size_t n, double chance, double bound) {
  double total = 0.0;
  for (std::size_t k = 0; k <= n; ++k) {
    const double ways = std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
    const double k_of_n = std::exp(ways + k * std::log(chance) + (n - k) * std::log1p(-chance));
    if (wilson(k, n).low > bound) total += k_of_n;
  }
  return total;
}

TEST_CASE("with as many trials as it says about half of all studies decide a share, with three times as many most") {
  for (const auto& [chance, bound] : {std::pair{0.95, 0.8}, {0.9, 0.6}, {0.7, 0.5}, {0.99, 0.95}}) {
    CAPTURE(chance);
    const auto needed = static_cast<std::size_t>(std::ceil(wilson_trials(chance, bound)));

    CHECK(decided(needed, chance, bound) > 0.35);
    CHECK(decided(needed, chance, bound) < 0.75);
    CHECK(decided(3 * needed, chance, bound) > 0.8);
    CHECK(wilson(needed * 1000, needed * 1000).low > bound);
  }
  CHECK(std::isinf(wilson_trials(0.5, 0.5)));
  CHECK(wilson(380, 380).low < 0.99);  // two of two and 0.99: 381 trials without a failure
  CHECK(wilson(381, 381).low > 0.99);
  CHECK(std::ceil(wilson_trials(1.0, 0.99)) == 381);
}

}  // namespace
}  // namespace gust
