#include "gust/eval/margin.h"

#include <cmath>

#include "gust/core/error.h"
#include "gust/eval/resampled_mean.h"
#include "gust/eval/statistics.h"

namespace gust {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void check_curve(const Curve& curve) {
  GUST_CHECK(!curve.levels.empty() && curve.levels.size() == curve.cells.size());
  const Cell& first = curve.cells.front();
  for (std::size_t level = 0; level < curve.cells.size(); ++level) {
    GUST_CHECK(curve.cells[level].rows == first.rows && curve.cells[level].lanes == first.lanes);
    GUST_CHECK(level == 0 || curve.levels[level] > curve.levels[level - 1]);
  }
}

/// The scores at one level, one a seed, or one an episode if there is one seed.
std::vector<double> unit_scores(const Cell& cell) {
  Matrix<double> counted(cell.rows, cell.lanes);
  for (std::size_t seed = 0; seed < cell.rows; ++seed) {
    for (std::size_t episode = 0; episode < cell.lanes; ++episode) {
      const double score = cell.at(seed, episode);
      counted.at(seed, episode) = std::isnan(score) ? 0.0 : score;
    }
  }
  return unit_values(counted.view());
}

/// One seed's curve is the mean over its episodes, whatever the statistic of the seeds.
std::size_t dropped(const Interval& interval, Statistic statistic) {
  return interval.unit == Unit::seeds ? dropped_values(statistic, interval.n) : 0;
}

/// Where a score that is not below the threshold at one level and is at the next one falls below it.
double crossing_between(double level, double next_level, double score, double next_score, double threshold) {
  return level + (score - threshold) / (score - next_score) * (next_level - level);
}

/// Follows the curves of a block of resamples from level to level: what it holds does not grow with them.
class CrossingScan {
 public:
  CrossingScan(const MarginRule& rule, std::span<double> found) : rule_(rule), found_(found), open_(found.size()) {
    std::fill(found_.begin(), found_.end(), kInfinity);
  }

  /// Whether a curve is left that has not crossed yet.
  bool open() const { return open_ > 0; }

  void first(double level, std::span<const double> scores) {
    threshold_.assign(scores.size(), 0.0);
    for (std::size_t k = 0; k < scores.size(); ++k) {
      threshold_[k] = rule_.fraction * scores[k];
      if (!(scores[k] > 0.0)) close(k, level);
    }
    move_on(level, scores);
  }

  void next(double level, std::span<const double> scores) {
    for (std::size_t k = 0; k < scores.size(); ++k) {
      if (scores[k] >= threshold_[k] || std::isfinite(found_[k])) continue;
      close(k, rule_.interpolated ? crossing_between(level_, level, scores_[k], scores[k], threshold_[k]) : level);
    }
    move_on(level, scores);
  }

 private:
  void close(std::size_t k, double level) {
    found_[k] = level;
    --open_;
  }

  void move_on(double level, std::span<const double> scores) {
    level_ = level;
    scores_.assign(scores.begin(), scores.end());
  }

  const MarginRule& rule_;
  std::span<double> found_;
  std::size_t open_;
  double level_ = 0;  // the level before
  std::vector<double> scores_;
  std::vector<double> threshold_;
};

/// The crossing in each resample.
std::vector<double> resampled_crossings(const Curve& curve, const Interval& units, const MarginRule& rule,
                                        Bootstrap& bootstrap) {
  const std::size_t drop = dropped(units, rule.statistic);
  std::vector<double> crossings(bootstrap.resamples());
  bootstrap.for_each_block(std::span(&units.n, 1), [&](std::size_t first, const Rows<const std::uint16_t>& times) {
    CrossingScan scan(rule, std::span(crossings).subspan(first, times.lanes));
    std::vector<double> means(times.lanes);
    for (std::size_t level = 0; level < curve.levels.size() && scan.open(); ++level) {
      resampled_means(trimmed_values(unit_scores(curve.cells[level]), drop), times, means);
      level == 0 ? scan.first(curve.levels[level], means) : scan.next(curve.levels[level], means);
    }
  });
  return crossings;
}

/// A number of a margin; an infinite one is censored.
std::string level_text(double level, double last) {
  return std::isinf(level) ? fmt::format("≥ {:.3g}", last) : fmt::format("{:.3g}", level);
}

}  // namespace

double crossing(std::span<const double> levels, std::span<const double> scores, const MarginRule& rule) {
  if (!(scores.front() > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  const double threshold = rule.fraction * scores.front();
  for (std::size_t i = 1; i < scores.size(); ++i) {
    if (scores[i] >= threshold) continue;
    if (!rule.interpolated) return levels[i];
    return crossing_between(levels[i - 1], levels[i], scores[i - 1], scores[i], threshold);
  }
  return kInfinity;
}

Margin margin(const Curve& curve, const MarginRule& rule, Bootstrap& bootstrap) {
  check_curve(curve);
  Margin result;
  result.last_level = curve.levels.back();
  const Cell& cell = curve.cells.front();
  result.level.unit = unit_of(cell);
  result.level.n = result.level.unit == Unit::seeds ? cell.rows : cell.lanes;
  std::vector<double> means(curve.levels.size());
  for (std::size_t level = 0; level < curve.levels.size(); ++level) {
    const std::vector<double> scores = unit_scores(curve.cells[level]);
    if (!all_finite(scores)) return result;
    means[level] = result.level.unit == Unit::seeds ? aggregate(rule.statistic, scores) : mean(scores);
  }
  result.level.estimate = crossing(curve.levels, means, rule);
  if (std::isnan(result.level.estimate)) return result;

  result.censored = std::isinf(result.level.estimate);
  if (result.censored) result.level.estimate = result.last_level;
  if (result.level.unit == Unit::none) return result;
  std::vector<double> crossings = resampled_crossings(curve, result.level, rule, bootstrap);
  bootstrap.bound(result.level, crossings);
  result.level.low = std::min(result.level.low, result.last_level);
  return result;
}

bool falls_short(double nominal, double best, const MarginRule& rule) {
  return best > 0 && nominal < rule.fraction * best;
}

std::string margin_text(const Margin& margin) {
  const Interval& level = margin.level;
  if (std::isnan(level.estimate)) return "none";
  const std::string estimate = level_text(margin.censored ? kInfinity : level.estimate, margin.last_level);
  const bool nothing_more = std::isnan(level.low) || (margin.censored && level.low == margin.last_level);
  if (nothing_more) return estimate;
  return cat(estimate, " [", level_text(level.low, margin.last_level), ", ", level_text(level.high, margin.last_level),
             "]");
}

std::vector<double> areas(const Curve& curve) {
  check_curve(curve);
  const double range = curve.levels.back() - curve.levels.front();
  std::vector<double> before = unit_scores(curve.cells.front());
  if (curve.levels.size() == 1) return before;
  std::vector<double> result(before.size(), 0.0);
  for (std::size_t i = 1; i < curve.levels.size(); ++i) {
    const std::vector<double> scores = unit_scores(curve.cells[i]);
    const double width = (curve.levels[i] - curve.levels[i - 1]) / range;
    for (std::size_t unit = 0; unit < result.size(); ++unit) {
      result[unit] += 0.5 * width * (before[unit] + scores[unit]);
    }
    before = scores;
  }
  return result;
}

Interval area(const Curve& curve, Bootstrap& bootstrap) {
  const std::vector<double> values = areas(curve);
  const bool seeds = curve.cells.front().rows > 1;
  return interval(cell_of(values, seeds ? values.size() : 1), Statistic::mean, bootstrap);
}

}  // namespace gust
