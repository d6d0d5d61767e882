#include "gust/stats/quotient.h"

#include "gust/core/error.h"
#include "gust/stats/statistics.h"

namespace gust {

Matrix<double> quotient_values(const Cell& numerator, const Cell& denominator) {
  GUST_CHECK(numerator.rows == denominator.rows && numerator.lanes == denominator.lanes);
  Matrix<double> values(numerator.rows, numerator.lanes);
  for (std::size_t seed = 0; seed < numerator.rows; ++seed) {
    const double mean_denominator = mean(denominator.row(seed));
    const double quotient = mean(numerator.row(seed)) / mean_denominator;
    for (std::size_t episode = 0; episode < numerator.lanes; ++episode) {
      const double deviation = numerator.at(seed, episode) - quotient * denominator.at(seed, episode);
      values.at(seed, episode) = quotient + deviation / mean_denominator;
    }
  }
  return values;
}

}  // namespace gust
