#include "gust/stats/aggregate.h"

#include <algorithm>
#include <limits>

#include "gust/core/error.h"
#include "gust/stats/resampled_mean.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

/// All tasks as the bootstrap sees them.
struct Sample {
  std::vector<double> runs;         ///< the value of each seed of each task, averaged over its episodes
  std::vector<std::size_t> strata;  ///< how many units each task has
  Unit unit = Unit::none;
  std::size_t n = 0;
};

std::size_t size_in(Unit unit, const Cell& cell) { return unit == Unit::seeds ? cell.rows : cell.lanes; }

Sample sample_of(std::span<const Cell> tasks) {
  Sample sample;
  for (const Cell& task : tasks) {
    GUST_CHECK(task.rows > 0 && task.lanes > 0);
    sample.unit = std::max(sample.unit, unit_of(task));
    for (std::size_t seed = 0; seed < task.rows; ++seed) sample.runs.push_back(mean(task.row(seed)));
  }
  for (const Cell& task : tasks) {
    const std::size_t size = size_in(sample.unit, task);
    sample.strata.push_back(size);
    if (size > 1) sample.n = sample.n == 0 ? size : std::min(sample.n, size);
  }
  if (sample.unit == Unit::none && !tasks.empty()) sample.n = 1;
  return sample;
}

Interval without_bounds(const Sample& sample, double estimate) {
  return {.estimate = estimate, .unit = sample.unit, .n = sample.n};
}

/// Interval of a trimmed mean of values that belong to the sample's seeds.
Interval over_seeds(const Sample& sample, std::span<const double> values, std::size_t drop, Bootstrap& bootstrap) {
  const TrimmedValues prepared = trimmed_values(values, drop);
  std::vector<double> resampled(bootstrap.resamples());
  bootstrap.for_each_block(sample.strata, [&](std::size_t first, const Rows<const std::uint16_t>& times) {
    resampled_means(prepared, times, std::span(resampled).subspan(first, times.lanes));
  });
  Interval result = without_bounds(sample, trimmed_mean(prepared.ascending, drop));
  bootstrap.bound(result, resampled);
  return result;
}

/// The same for any statistic: writes out each resample.
Interval over_seeds(const Sample& sample, const StatisticFunction& statistic, Bootstrap& bootstrap) {
  std::vector<double> resampled(bootstrap.resamples());
  bootstrap.for_each_block(sample.strata, [&](std::size_t first, const Rows<const std::uint16_t>& times) {
    std::vector<double> drawn;
    for (std::size_t k = 0; k < times.lanes; ++k) {
      drawn.clear();
      for (std::size_t i = 0; i < times.rows; ++i) drawn.insert(drawn.end(), times.at(i, k), sample.runs[i]);
      resampled[first + k] = statistic(drawn);
    }
  });
  Interval result = without_bounds(sample, statistic(sample.runs));
  bootstrap.bound(result, resampled);
  return result;
}

/// One seed a task: draws episodes within each task, and takes the statistic of the tasks' means.
Interval over_episodes(std::span<const Cell> tasks, const StatisticFunction& statistic, Bootstrap& bootstrap) {
  const Sample sample = sample_of(tasks);
  std::vector<GroupedValues> episodes;
  std::vector<std::size_t> strata;
  for (const Cell& task : tasks) strata.push_back(episodes.emplace_back(task.row(0)).groups());
  std::vector<double> resampled(bootstrap.resamples());
  Matrix<double> means(tasks.size(), Bootstrap::kBlock);
  std::vector<double> drawn(tasks.size());
  bootstrap.for_each_block(strata, [&](std::size_t first, Rows<const std::uint16_t> times) {
    for (std::size_t task = 0; task < tasks.size(); ++task) {
      episodes[task].resampled_means(times.first_rows(strata[task]), means.row(task).first(times.lanes));
      times.data += strata[task] * times.stride;
    }
    for (std::size_t k = 0; k < times.lanes; ++k) {
      for (std::size_t task = 0; task < tasks.size(); ++task) drawn[task] = means.at(task, k);
      resampled[first + k] = statistic(drawn);
    }
  });
  Interval result = without_bounds(sample, statistic(sample.runs));
  bootstrap.bound(result, resampled);
  return result;
}

bool resamples_exist(const Sample& sample, std::span<const Cell> tasks) {
  if (sample.unit == Unit::none || !all_finite(sample.runs)) return false;
  return sample.unit == Unit::seeds ||
         std::all_of(tasks.begin(), tasks.end(), [](const Cell& task) { return all_finite(task.row(0)); });
}

/// The mean over all runs of a function of the run's value.
template <class Transform>
Interval mean_of(std::span<const Cell> tasks, Transform transform, Bootstrap& bootstrap) {
  const Sample sample = sample_of(tasks);
  const StatisticFunction statistic = [&](std::span<const double> runs) {
    std::vector<double> values(runs.begin(), runs.end());
    std::transform(values.begin(), values.end(), values.begin(), transform);
    return mean(values);
  };
  if (!resamples_exist(sample, tasks)) return without_bounds(sample, statistic(sample.runs));
  if (sample.unit == Unit::episodes) return over_episodes(tasks, statistic, bootstrap);
  std::vector<double> values = sample.runs;
  std::transform(values.begin(), values.end(), values.begin(), transform);
  return over_seeds(sample, values, 0, bootstrap);
}

}  // namespace

double aggregate(Statistic statistic, std::span<const double> values) {
  switch (statistic) {
    case Statistic::mean:
      return mean(values);
    case Statistic::median:
      return median(values);
    case Statistic::iqm:
      break;
  }
  return iqm(values);
}

std::size_t dropped_values(Statistic statistic, std::size_t n) {
  switch (statistic) {
    case Statistic::mean:
      return 0;
    case Statistic::median:
      return (n - 1) / 2;
    case Statistic::iqm:
      break;
  }
  return n / 4;
}

std::vector<double> unit_values(const Cell& cell) {
  if (unit_of(cell) != Unit::seeds) return {cell.row(0).begin(), cell.row(0).end()};
  std::vector<double> values(cell.rows);
  for (std::size_t seed = 0; seed < cell.rows; ++seed) values[seed] = mean(cell.row(seed));
  return values;
}

Unit unit_of(const Cell& cell) {
  GUST_CHECK(cell.rows > 0 && cell.lanes > 0);
  if (cell.rows > 1) return Unit::seeds;
  return cell.lanes > 1 ? Unit::episodes : Unit::none;
}

Interval interval(std::span<const Cell> tasks, Statistic statistic, Bootstrap& bootstrap) {
  const Sample sample = sample_of(tasks);
  if (!resamples_exist(sample, tasks)) return without_bounds(sample, aggregate(statistic, sample.runs));
  if (sample.unit == Unit::seeds) {
    return over_seeds(sample, sample.runs, dropped_values(statistic, sample.runs.size()), bootstrap);
  }
  return over_episodes(
      tasks, [&](std::span<const double> runs) { return aggregate(statistic, runs); }, bootstrap);
}

Interval interval(const Cell& cell, Statistic statistic, Bootstrap& bootstrap) {
  return interval(std::span(&cell, 1), statistic, bootstrap);
}

Interval interval(std::span<const Cell> tasks, const StatisticFunction& statistic, Bootstrap& bootstrap) {
  const Sample sample = sample_of(tasks);
  if (!resamples_exist(sample, tasks)) return without_bounds(sample, statistic(sample.runs));
  if (sample.unit == Unit::seeds) return over_seeds(sample, statistic, bootstrap);
  return over_episodes(tasks, statistic, bootstrap);
}

Interval optimality_gap_interval(std::span<const Cell> tasks, double gamma, Bootstrap& bootstrap) {
  return mean_of(
      tasks, [gamma](double run) { return run > gamma ? 0.0 : gamma - run; }, bootstrap);
}

std::vector<Interval> performance_profile(std::span<const Cell> tasks, std::span<const double> thresholds,
                                          Bootstrap& bootstrap) {
  std::vector<Interval> profile;
  for (const double threshold : thresholds) {
    profile.push_back(mean_of(
        tasks, [threshold](double run) { return run > threshold ? 1.0 : 0.0; }, bootstrap));
  }
  return profile;
}

}  // namespace gust
