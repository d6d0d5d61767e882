#include "gust/stats/rank_correlation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/error.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

int sign(double value) { return (value > 0) - (value < 0); }

std::vector<double> ranks(std::span<const double> values) {
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto below = std::ranges::count_if(values, [&](double value) { return value < values[i]; });
    const auto equal = std::ranges::count(values, values[i]);
    ranks[i] = static_cast<double>(below) + 0.5 * static_cast<double>(equal + 1);
  }
  return ranks;
}

}  // namespace

double pearson(std::span<const double> x, std::span<const double> y) {
  GUST_CHECK(x.size() == y.size());
  if (x.size() < 2) return kUnknown;
  const double mean_x = mean(x), mean_y = mean(y);
  double xx = 0, yy = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  return xx > 0 && yy > 0 ? std::clamp(xy / std::sqrt(xx * yy), -1.0, 1.0) : kUnknown;
}

double spearman(std::span<const double> x, std::span<const double> y) {
  const std::vector<double> of_x = ranks(x), of_y = ranks(y);
  return pearson(of_x, of_y);
}

double kendall(std::span<const double> x, std::span<const double> y) {
  GUST_CHECK(x.size() == y.size());
  double concordance = 0, untied_x = 0, untied_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const int in_x = sign(x[i] - x[j]), in_y = sign(y[i] - y[j]);
      concordance += in_x * in_y;
      untied_x += in_x * in_x;
      untied_y += in_y * in_y;
    }
  }
  return untied_x > 0 && untied_y > 0 ? concordance / std::sqrt(untied_x * untied_y) : kUnknown;
}

}  // namespace gust
