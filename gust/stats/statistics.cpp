#include "gust/stats/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/error.h"

namespace gust {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The values in ascending order; none at all if one of them is NaN.
std::vector<double> sorted(std::span<const double> values) {
  std::vector<double> copy(values.begin(), values.end());
  if (std::any_of(copy.begin(), copy.end(), [](double value) { return std::isnan(value); })) copy.clear();
  std::sort(copy.begin(), copy.end());
  return copy;
}

/// From a to b as t goes from 0 to 1, rounded as numpy.quantile does it.
double between(double a, double b, double t) {
  if (a == b || t == 0.0) return a;
  if (std::isinf(a) || std::isinf(b)) return std::isinf(b) ? b : a;  // the formula would give NaN
  return t < 0.5 ? a + (b - a) * t : b - (b - a) * (1.0 - t);
}

}  // namespace

double mean(std::span<const double> values) {
  if (values.empty()) return kNaN;
  // Relative to the first value, so that equal values give exactly that value.
  const double origin = values.front();
  double sum = 0.0;
  for (const double value : values) sum += value - origin;
  const double result = origin + sum / static_cast<double>(values.size());
  if (std::isfinite(result)) return result;
  double plain = 0.0;
  for (const double value : values) plain += value;
  return plain / static_cast<double>(values.size());
}

double sample_deviation(std::span<const double> values) {
  if (values.size() < 2) return kNaN;
  const double center = mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - center) * (value - center);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double median(std::span<const double> values) {
  const std::vector<double> ascending = sorted(values);
  return ascending.empty() ? kNaN : trimmed_mean(ascending, (ascending.size() - 1) / 2);
}

double iqm(std::span<const double> values) {
  const std::vector<double> ascending = sorted(values);
  return ascending.empty() ? kNaN : trimmed_mean(ascending, ascending.size() / 4);
}

double optimality_gap(std::span<const double> values, double gamma) {
  std::vector<double> capped(values.begin(), values.end());
  for (double& value : capped) value = value > gamma ? gamma : value;
  return gamma - mean(capped);
}

double quantile(std::span<const double> values, double q) {
  std::vector<double> ascending = sorted(values);
  return ascending.empty() ? kNaN : quantile_reordering(ascending, q);
}

double quantile_reordering(std::span<double> values, double q) {
  GUST_CHECK(!values.empty() && q >= 0.0 && q <= 1.0);
  const double position = static_cast<double>(values.size() - 1) * q;
  const auto index = static_cast<std::ptrdiff_t>(position);
  const auto lower = values.begin() + index;
  std::nth_element(values.begin(), lower, values.end());
  const auto upper = lower + 1 == values.end() ? lower : std::min_element(lower + 1, values.end());
  return between(*lower, *upper, position - static_cast<double>(index));
}

double trimmed_mean(std::span<const double> ascending, std::size_t drop) {
  GUST_CHECK(ascending.size() > 2 * drop);
  return mean(ascending.subspan(drop, ascending.size() - 2 * drop));
}

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace gust
