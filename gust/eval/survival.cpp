#include "gust/eval/survival.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "gust/core/error.h"
#include "gust/eval/aggregate.h"

namespace gust {

Interval wilson(std::size_t successes, std::size_t trials, double confidence) {
  GUST_CHECK(trials > 0 && successes <= trials && confidence > 0.0 && confidence < 1.0);
  // Center and half width of the values p with |share - p| <= z sqrt(p (1 - p) / n).
  const double z = boost::math::quantile(boost::math::normal(), 0.5 + 0.5 * confidence);
  const double n = static_cast<double>(trials);
  const double share = static_cast<double>(successes) / n;
  const double shrink = 1.0 / (1.0 + z * z / n);
  const double center = shrink * (share + z * z / (2.0 * n));
  const double half = shrink * z * std::sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n));

  Interval result{.estimate = share, .unit = Unit::episodes, .n = trials};
  result.low = successes == 0 ? 0.0 : center - half;
  result.high = successes == trials ? 1.0 : center + half;
  return result;
}

Interval survival_interval(const Cell& survived, Bootstrap& bootstrap) {
  GUST_CHECK(survived.rows > 0 && survived.lanes > 0);
  Matrix<double> values(survived.rows, survived.lanes);
  std::size_t successes = 0;
  for (std::size_t seed = 0; seed < survived.rows; ++seed) {
    for (std::size_t episode = 0; episode < survived.lanes; ++episode) {
      const bool success = survived.at(seed, episode) == 1.0;
      values.at(seed, episode) = success ? 1.0 : 0.0;
      successes += success ? 1 : 0;
    }
  }
  Interval result = wilson(successes, survived.rows * survived.lanes, bootstrap.confidence());
  if (survived.rows == 1) return result;
  const Interval seeds = interval(values.view(), Statistic::mean, bootstrap);
  result.low = std::min(result.low, seeds.low);
  result.high = std::max(result.high, seeds.high);
  result.unit = Unit::seeds;
  result.n = survived.rows;
  return result;
}

}  // namespace gust
