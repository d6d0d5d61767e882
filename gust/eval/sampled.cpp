#include "gust/eval/sampled.h"

#include <cmath>

#include "gust/eval/statistics.h"

namespace gust {

Interval interval_of(const Sampled& number, double confidence) {
  Interval interval{.estimate = number.estimate()};
  std::vector<double> resampled(number.values.begin() + (number.is_constant() ? 0 : 1), number.values.end());
  if (std::ranges::any_of(resampled, [](double value) { return std::isnan(value); })) return interval;
  interval.low = quantile_reordering(resampled, 0.5 * (1.0 - confidence));
  interval.high = quantile_reordering(resampled, 0.5 * (1.0 + confidence));
  return interval;
}

}  // namespace gust
