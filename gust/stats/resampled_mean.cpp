#include "gust/stats/resampled_mean.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "gust/core/error.h"
#include "gust/stats/bootstrap.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

/// Ranks in a resample that are not dropped, end exclusive.
struct Kept {
  std::int32_t begin;
  std::int32_t end;
};

/// One sum and one count of the values so far for each resample.
struct Running {
  alignas(64) std::array<double, Bootstrap::kBlock> sums{};
  alignas(64) std::array<std::int32_t, Bootstrap::kBlock> rank{};
};

/// Adds value to the sums as often as it is drawn at a rank that is kept. Values must come in ascending order.
void add_kept(double value, std::span<const std::uint16_t> times, Kept kept, Running& running) {
  for (std::size_t k = 0; k < times.size(); ++k) {
    const std::int32_t next = running.rank[k] + times[k];
    const std::int32_t first = std::clamp(running.rank[k], kept.begin, kept.end);
    const std::int32_t last = std::clamp(next, kept.begin, kept.end);
    running.sums[k] += value * (last - first);
    running.rank[k] = next;
  }
}

/// The same when none is dropped.
void add_all(double value, std::span<const std::uint16_t> times, Running& running) {
  for (std::size_t k = 0; k < times.size(); ++k) running.sums[k] += value * times[k];
}

}  // namespace

TrimmedValues trimmed_values(std::span<const double> values, std::size_t drop) {
  GUST_CHECK(values.size() > 2 * drop && all_finite(values));
  TrimmedValues result;
  result.drop = drop;
  result.unit.resize(values.size());
  std::iota(result.unit.begin(), result.unit.end(), std::size_t{0});
  std::stable_sort(result.unit.begin(), result.unit.end(),
                   [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  for (const std::size_t unit : result.unit) result.ascending.push_back(values[unit]);
  return result;
}

void resampled_means(const TrimmedValues& values, const Rows<const std::uint16_t>& times, std::span<double> out) {
  const std::size_t n = values.ascending.size();
  GUST_CHECK(times.rows == n && times.lanes <= Bootstrap::kBlock && out.size() == times.lanes);
  Running running;
  // Sums of distances from one of the kept values: they are exactly zero where all kept values are equal.
  const double origin = values.ascending[values.drop];
  const Kept kept{static_cast<std::int32_t>(values.drop), static_cast<std::int32_t>(n - values.drop)};
  for (std::size_t i = 0; i < n; ++i) {
    const double distance = values.ascending[i] - origin;
    const auto drawn = times.row(values.unit[i]);
    if (values.drop == 0) {
      add_all(distance, drawn, running);
    } else {
      add_kept(distance, drawn, kept, running);
    }
  }
  const double count = static_cast<double>(n - 2 * values.drop);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = origin + running.sums[k] / count;
}

GroupedValues::GroupedValues(std::span<const double> values)
    : total_(values.size()), size_(Bootstrap::group_size(total_)) {
  std::vector<double> groups(total_ / size_);
  for (std::size_t i = 0; i < groups.size(); ++i)
    groups[i] = size_ == 1 ? values[i] : mean(values.subspan(i * size_, size_));
  for (std::size_t i = groups.size() * size_; i < total_; ++i) left_over_ += values[i];
  drawn_ = trimmed_values(groups, 0);
}

void GroupedValues::resampled_means(const Rows<const std::uint16_t>& times, std::span<double> out) const {
  gust::resampled_means(drawn_, times, out);
  if (size_ == 1) return;
  for (double& value : out)
    value = (value * static_cast<double>(groups() * size_) + left_over_) / static_cast<double>(total_);
}

}  // namespace gust
