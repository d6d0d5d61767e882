#include "gust/stats/share.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <limits>

#include "gust/core/error.h"
#include "gust/stats/aggregate.h"

namespace gust {

double wilson_end(double share, double trials, double tail) {
  GUST_CHECK(trials > 0.0 && share >= 0.0 && share <= 1.0 && tail >= 0.0 && tail <= 1.0);
  if (tail == 0.0 || tail == 1.0) return tail;
  // Center and half width of the values p with |share - p| <= |z| sqrt(p (1 - p) / n).
  const double z = boost::math::quantile(boost::math::normal(), tail);
  const double shrink = 1.0 / (1.0 + z * z / trials);
  const double center = shrink * (share + z * z / (2.0 * trials));
  const double half = shrink * z * std::sqrt(share * (1.0 - share) / trials + z * z / (4.0 * trials * trials));
  if (share == 0.0 && tail <= 0.5) return 0.0;
  if (share == 1.0 && tail >= 0.5) return 1.0;
  return center + half;
}

double wilson_trials(double share, double bound, double confidence) {
  const double z = boost::math::quantile(boost::math::normal(), 0.5 + 0.5 * confidence);
  if (share == bound) return std::numeric_limits<double>::infinity();
  const double trials = z * z * bound * (1.0 - bound) / ((share - bound) * (share - bound));
  return std::max(trials, 0.0);
}

Interval wilson(std::size_t successes, std::size_t trials, double confidence) {
  GUST_CHECK(trials > 0 && successes <= trials && confidence > 0.0 && confidence < 1.0);
  const auto n = static_cast<double>(trials);
  const double share = static_cast<double>(successes) / n;
  Interval result{.estimate = share, .unit = Unit::episodes, .n = trials};
  result.low = wilson_end(share, n, 0.5 - 0.5 * confidence);
  result.high = wilson_end(share, n, 0.5 + 0.5 * confidence);
  return result;
}

Interval share_interval(const Cell& successes, Bootstrap& bootstrap) {
  GUST_CHECK(successes.rows > 0 && successes.lanes > 0);
  Matrix<double> values(successes.rows, successes.lanes);
  std::size_t count = 0;
  for (std::size_t seed = 0; seed < successes.rows; ++seed) {
    for (std::size_t episode = 0; episode < successes.lanes; ++episode) {
      const bool success = successes.at(seed, episode) == 1.0;
      values.at(seed, episode) = success ? 1.0 : 0.0;
      count += success ? 1 : 0;
    }
  }
  Interval result = wilson(count, successes.rows * successes.lanes, bootstrap.confidence());
  if (successes.rows == 1) return result;
  const Interval seeds = interval(values.view(), Statistic::mean, bootstrap);
  result.low = std::min(result.low, seeds.low);
  result.high = std::max(result.high, seeds.high);
  result.unit = Unit::seeds;
  result.n = successes.rows;
  return result;
}

}  // namespace gust
