#include "gust/stats/sampled.h"

#include <algorithm>
#include <cmath>

#include "gust/stats/statistics.h"

namespace gust {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A product of ends: 0 times an end that is not bounded is 0, for no number between the ends is infinite.
double times(double a, double b) { return a == 0.0 || b == 0.0 ? 0.0 : a * b; }

double percentile(std::span<const double> ends, double share) {
  std::vector<double> resampled(ends.begin() + (ends.size() == 1 ? 0 : 1), ends.end());
  return quantile_reordering(resampled, share);
}

}  // namespace

Bounds operator-(const Bounds& range) { return {-range.high, -range.low}; }
Bounds operator+(const Bounds& a, const Bounds& b) { return {a.low + b.low, a.high + b.high}; }
Bounds operator-(const Bounds& a, const Bounds& b) { return {a.low - b.high, a.high - b.low}; }

Bounds operator*(const Bounds& a, const Bounds& b) {
  if (a.exact() && b.exact()) return a.low * b.low;
  const auto [low, high] =
      std::minmax({times(a.low, b.low), times(a.low, b.high), times(a.high, b.low), times(a.high, b.high)});
  return {low, high};
}

Bounds operator/(const Bounds& a, const Bounds& b) {
  if (b.exact() && b.low == 0.0) return kUnknown;
  if (a.exact() && b.exact()) return a.low / b.low;
  if (b.low <= 0.0 && b.high >= 0.0) return Bounds::unknown();
  return a * Bounds(1.0 / b.high, 1.0 / b.low);
}

Bounds abs(const Bounds& range) {
  if (range.exact()) return std::abs(range.low);
  const double far = std::max(std::abs(range.low), std::abs(range.high));
  const bool around_zero = range.low <= 0.0 && range.high >= 0.0;
  return {around_zero ? 0.0 : std::min(std::abs(range.low), std::abs(range.high)), far};
}

void Sampled::set(std::size_t i, const Bounds& range) {
  if (!range.exact() && upper.empty()) upper = values;
  values[i] = range.low;
  if (!upper.empty()) upper[i] = range.high;
}

void Sampled::inherit(const Sampled& from) {
  if (limit.empty()) limit = from.limit;
  if (from.is_constant()) return;
  const bool first = n == 0 && !mixed;
  mixed = mixed || from.mixed || (!first && unit != from.unit);
  n = first ? from.n : std::min(n, from.n);
  at_ends = from.at_ends && (first || at_ends);
  unit = mixed ? Unit::none : from.unit;
}

Sampled between(std::span<const Sampled> numbers, Sampled result) {
  const auto is_share = [](const Sampled& number) {
    return number.is_share || (number.is_constant() && number.estimate() >= 0.0 && number.estimate() <= 1.0);
  };
  result.is_share = !result.is_constant() && std::ranges::all_of(numbers, is_share);
  return result;
}

Interval interval_of(const Sampled& number, double confidence) {
  Interval interval{.estimate = number.estimate(), .unit = number.unit, .n = number.n};
  if (!number.bounds(0).exact()) interval.most = number.bounds(0).high;
  const std::span<const double> resamples = std::span(number.values).subspan(number.is_constant() ? 0 : 1);
  if (std::ranges::any_of(resamples, [](double value) { return std::isnan(value); })) return interval;
  interval.low = percentile(number.values, 0.5 * (1.0 - confidence));
  interval.high = percentile(number.upper_ends(), 0.5 * (1.0 + confidence));
  return interval;
}

}  // namespace gust
