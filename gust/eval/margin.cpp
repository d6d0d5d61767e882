#include "gust/eval/margin.h"

#include <cmath>

#include "gust/core/error.h"
#include "gust/eval/resampled_mean.h"
#include "gust/eval/statistics.h"

namespace gust {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Scores of each unit: a row is a level, a lane a seed (or an episode, if there is one seed).
struct Scores {
  Matrix<double> values;
  Unit unit = Unit::none;
};

Scores scores_of(const Curve& curve) {
  GUST_CHECK(!curve.levels.empty() && curve.levels.size() == curve.cells.size());
  const Cell& first = curve.cells.front();
  const Unit unit = unit_of(first);
  Scores scores{Matrix<double>(curve.cells.size(), unit == Unit::seeds ? first.rows : first.lanes), unit};
  for (std::size_t level = 0; level < curve.cells.size(); ++level) {
    const Cell& cell = curve.cells[level];
    GUST_CHECK(cell.rows == first.rows && cell.lanes == first.lanes);
    GUST_CHECK(level == 0 || curve.levels[level] > curve.levels[level - 1]);
    Matrix<double> counted(cell.rows, cell.lanes);
    for (std::size_t seed = 0; seed < cell.rows; ++seed) {
      for (std::size_t episode = 0; episode < cell.lanes; ++episode) {
        const double score = cell.at(seed, episode);
        counted.at(seed, episode) = std::isnan(score) ? 0.0 : score;
      }
    }
    const std::vector<double> units = unit_values(counted.view());
    std::copy(units.begin(), units.end(), scores.values.row(level).begin());
  }
  return scores;
}

/// One seed's curve is the mean over its episodes, whatever the statistic of the seeds.
std::size_t dropped(const Scores& scores, Statistic statistic) {
  return scores.unit == Unit::seeds ? dropped_values(statistic, scores.values.lanes()) : 0;
}

/// The crossing in each resample.
std::vector<double> resampled_crossings(const Curve& curve, const Scores& scores, const MarginRule& rule,
                                        Bootstrap& bootstrap) {
  const std::size_t levels = curve.levels.size();
  std::vector<TrimmedValues> prepared;
  for (std::size_t level = 0; level < levels; ++level) {
    prepared.push_back(trimmed_values(scores.values.row(level), dropped(scores, rule.statistic)));
  }
  std::vector<double> crossings(bootstrap.resamples());
  Matrix<double> means(levels, Bootstrap::kBlock);
  std::vector<double> drawn(levels);
  const std::size_t units = scores.values.lanes();
  bootstrap.for_each_block(std::span(&units, 1), [&](std::size_t first, const Rows<const std::uint16_t>& times) {
    for (std::size_t level = 0; level < levels; ++level) {
      resampled_means(prepared[level], times, means.row(level).first(times.lanes));
    }
    for (std::size_t k = 0; k < times.lanes; ++k) {
      for (std::size_t level = 0; level < levels; ++level) drawn[level] = means.at(level, k);
      const double level = crossing(curve.levels, drawn, rule);
      crossings[first + k] = std::isnan(level) ? curve.levels.front() : level;
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
    const double share = (scores[i - 1] - threshold) / (scores[i - 1] - scores[i]);
    return levels[i - 1] + share * (levels[i] - levels[i - 1]);
  }
  return kInfinity;
}

Margin margin(const Curve& curve, const MarginRule& rule, Bootstrap& bootstrap) {
  const Scores scores = scores_of(curve);
  Margin result;
  result.last_level = curve.levels.back();
  std::vector<double> means(curve.levels.size());
  bool finite = true;
  for (std::size_t level = 0; level < curve.levels.size(); ++level) {
    const auto units = scores.values.row(level);
    finite = finite && all_finite(units);
    means[level] = scores.unit == Unit::seeds ? aggregate(rule.statistic, units) : mean(units);
  }
  result.level = {.unit = scores.unit, .n = scores.values.lanes()};
  if (!finite) return result;
  result.level.estimate = crossing(curve.levels, means, rule);
  if (std::isnan(result.level.estimate)) return result;

  result.censored = std::isinf(result.level.estimate);
  if (result.censored) result.level.estimate = result.last_level;
  if (scores.unit == Unit::none) return result;
  std::vector<double> crossings = resampled_crossings(curve, scores, rule, bootstrap);
  bootstrap.bound(result.level, crossings);
  result.level.low = std::min(result.level.low, result.last_level);
  return result;
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
  const Scores scores = scores_of(curve);
  const double range = curve.levels.back() - curve.levels.front();
  std::vector<double> result(scores.values.lanes(), 0.0);
  for (std::size_t unit = 0; unit < result.size(); ++unit) {
    if (curve.levels.size() == 1) result[unit] = scores.values.at(0, unit);
    for (std::size_t i = 1; i < curve.levels.size(); ++i) {
      const double width = (curve.levels[i] - curve.levels[i - 1]) / range;
      result[unit] += 0.5 * width * (scores.values.at(i - 1, unit) + scores.values.at(i, unit));
    }
  }
  return result;
}

Interval area(const Curve& curve, Bootstrap& bootstrap) {
  const std::vector<double> values = areas(curve);
  const bool seeds = curve.cells.front().rows > 1;
  return interval(cell_of(values, seeds ? values.size() : 1), Statistic::mean, bootstrap);
}

}  // namespace gust
