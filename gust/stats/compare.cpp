#include "gust/stats/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/error.h"
#include "gust/stats/aggregate.h"
#include "gust/stats/resampled_mean.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

using Times = Rows<const std::uint16_t>;

/// 1 where x is larger, 1/2 where both are equal, else 0.
double wins(double x, double y) { return x > y ? 1.0 : x == y ? 0.5 : 0.0; }

/// The values of both policies in one task, of seeds or of episodes.
struct Pairing {
  std::vector<double> x;
  std::vector<double> y;
  Unit unit = Unit::none;
};

/// The mean over episodes of each row.
std::vector<double> row_means(const Cell& cell) {
  std::vector<double> means(cell.rows);
  for (std::size_t seed = 0; seed < cell.rows; ++seed) means[seed] = mean(cell.row(seed));
  return means;
}

Pairing pairing_of(const Cell& x, const Cell& y) {
  const Unit unit = std::max(unit_of(x), unit_of(y));
  if (unit == Unit::seeds) return {row_means(x), row_means(y), unit};
  return {unit_values(x), unit_values(y), unit};
}

/// Adds the probability of improvement in each resample to the sums.
void add_resampled(const Pairing& task, const Times& times_x, const Times& times_y, std::span<double> sums) {
  std::array<double, Bootstrap::kBlock> won{};
  std::array<double, Bootstrap::kBlock> beaten;
  for (std::size_t i = 0; i < task.x.size(); ++i) {
    beaten.fill(0.0);
    for (std::size_t j = 0; j < task.y.size(); ++j) {
      const double win = wins(task.x[i], task.y[j]);
      const auto drawn = times_y.row(j);
      for (std::size_t k = 0; k < drawn.size(); ++k) beaten[k] += win * drawn[k];
    }
    const auto drawn = times_x.row(i);
    for (std::size_t k = 0; k < drawn.size(); ++k) won[k] += beaten[k] * drawn[k];
  }
  const double pairs = static_cast<double>(task.x.size() * task.y.size());
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += won[k] / pairs;
}

/// The rows of a block from `first` on.
Times part(const Times& times, std::size_t first, std::size_t count) {
  return {times.data + first * times.stride, count, times.lanes, times.stride};
}

/// The smaller of the sizes that are more than one; 1 if none is.
std::size_t smaller_side(std::span<const std::size_t> sizes) {
  std::size_t smallest = 1;
  for (const std::size_t size : sizes) {
    if (size > 1) smallest = smallest == 1 ? size : std::min(smallest, size);
  }
  return smallest;
}

}  // namespace

double probability_of_improvement(std::span<const double> x, std::span<const double> y) {
  double sum = 0.0;
  for (const double left : x) {
    for (const double right : y) sum += std::isnan(left) || std::isnan(right) ? left + right : wins(left, right);
  }
  return sum / (static_cast<double>(x.size()) * static_cast<double>(y.size()));
}

Interval probability_of_improvement(std::span<const Cell> x, std::span<const Cell> y, Bootstrap& bootstrap) {
  GUST_CHECK(x.size() == y.size() && !x.empty());
  std::vector<Pairing> tasks;
  std::vector<std::size_t> strata;
  std::vector<double> estimates;
  Interval result;
  bool finite = true;
  for (std::size_t i = 0; i < x.size(); ++i) {
    tasks.push_back(pairing_of(x[i], y[i]));
    strata.push_back(tasks[i].x.size());
    strata.push_back(tasks[i].y.size());
    estimates.push_back(probability_of_improvement(tasks[i].x, tasks[i].y));
    result.unit = std::max(result.unit, tasks[i].unit);
    finite = finite && all_finite(tasks[i].x) && all_finite(tasks[i].y);
  }
  result.estimate = mean(estimates);
  result.n = smaller_side(strata);
  if (!finite || result.unit == Unit::none) return result;

  std::vector<double> resampled(bootstrap.resamples(), 0.0);
  bootstrap.for_each_block(strata, [&](std::size_t first, const Times& times) {
    const auto block = std::span(resampled).subspan(first, times.lanes);
    std::size_t row = 0;
    for (const Pairing& task : tasks) {
      add_resampled(task, part(times, row, task.x.size()), part(times, row + task.x.size(), task.y.size()), block);
      row += task.x.size() + task.y.size();
    }
    for (double& sum : block) sum /= static_cast<double>(tasks.size());
  });
  bootstrap.bound(result, resampled);
  return result;
}

}  // namespace gust
