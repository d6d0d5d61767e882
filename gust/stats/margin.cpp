#include "gust/stats/margin.h"

#include <algorithm>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "gust/core/error.h"
#include "gust/core/math.h"
#include "gust/stats/statistics.h"

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

void check_curve(const MarginCurve& curve) {
  GUST_CHECK(!curve.levels.empty() && curve.levels.size() == curve.scores.size() && curve.levels.front() >= 0);
  const std::size_t units = curve.scores.front().size();
  GUST_CHECK(units > 0 && (curve.undisturbed.size() == units || curve.undisturbed.size() == 1));
  for (std::size_t i = 0; i < curve.levels.size(); ++i) {
    GUST_CHECK(curve.scores[i].size() == units);
    GUST_CHECK(i == 0 || curve.levels[i] > curve.levels[i - 1]);
  }
}

/// Where a score that is not below the threshold at one level and is at the next one falls below it.
double crossing_between(double level, double next_level, double score, double next_score, double threshold) {
  return level + (score - threshold) / (score - next_score) * (next_level - level);
}

/// The first place with a value below 0; the size where there is none.
std::size_t first_below(const std::vector<double>& values) {
  return static_cast<std::size_t>(std::ranges::find_if(values, [](double v) { return v < 0; }) - values.begin());
}

double undisturbed_of(const MarginCurve& curve, std::size_t unit) {
  return curve.undisturbed[curve.undisturbed.size() == 1 ? 0 : unit];
}

/// The logarithm of the level at which each unit falls by itself; the last level for one that does not.
std::vector<double> falling_levels(const MarginCurve& curve, const MarginRule& rule) {
  std::vector<double> out;
  for (std::size_t u = 0; u < curve.scores.front().size(); ++u) {
    const double threshold = rule.fraction * undisturbed_of(curve, u);
    double level = curve.levels.back();
    for (std::size_t i = 0; i < curve.levels.size(); ++i) {
      if (curve.scores[i][u] >= threshold) continue;
      level = i == 0 ? 0.0
                     : crossing_between(curve.levels[i - 1], curve.levels[i], curve.scores[i - 1][u],
                                        curve.scores[i][u], threshold);
      break;
    }
    if (level > 0) out.push_back(log(level));
  }
  return out;
}

/// The share of units that carries the loss at a level: 1 where all lose alike, p where a share p loses all of it.
double losing_share(const MarginCurve& curve, std::size_t level) {
  double sum = 0, squares = 0;
  const std::vector<double>& scores = curve.scores[level];
  for (std::size_t u = 0; u < scores.size(); ++u) {
    const double loss = std::max(0.0, undisturbed_of(curve, u) - scores[u]);
    sum += loss;
    squares += loss * loss;
  }
  return squares > 0 ? sum * sum / (static_cast<double>(scores.size()) * squares) : 1.0;
}

/// Whether the second level is the smallest that is ever looked at above 0.
bool is_smallest(std::span<const double> levels) {
  constexpr double kRounded = 1.001;  // levels have four digits
  return levels.front() == 0 && levels[1] <= kRounded * kSmallestLevel * levels.back();
}

/// A number of a margin; an infinite one is censored.
std::string level_text(double level, double last) {
  return std::isinf(level) ? fmt::format("≥ {:.3g}", last) : fmt::format("{:.3g}", level);
}

}  // namespace

void MarginCurve::add(double level, std::vector<double> scores_there) {
  const auto at = std::ranges::lower_bound(levels, level);
  if (at != levels.end() && *at == level) return;
  scores.insert(scores.begin() + (at - levels.begin()), std::move(scores_there));
  levels.insert(at, level);
}

Bounds crossing(std::span<const double> levels, std::span<const double> scores, double undisturbed,
                const MarginRule& rule) {
  if (!(undisturbed > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  const double threshold = rule.fraction * undisturbed;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i] >= threshold) continue;
    if (!rule.interpolated) return levels[i];
    if (i == 0) return {std::min(0.0, levels.front()), levels.front()};
    if (i == 1 && is_smallest(levels)) return {0.0, levels[1]};
    return crossing_between(levels[i - 1], levels[i], scores[i - 1], scores[i], threshold);
  }
  return {levels.back(), kInfinity};
}

bool falls_short(double nominal, double best, const MarginRule& rule) {
  return best > 0 && nominal < rule.fraction * best;
}

MarginBands margin_bands(const MarginCurve& curve, const MarginRule& rule) {
  check_curve(curve);
  const std::size_t units = curve.scores.front().size();
  double reach = 0;  // standard errors to either side
  if (units > 1) {
    const boost::math::students_t student(static_cast<double>(units - 1));
    reach = boost::math::quantile(student, 0.5 + 0.5 * rule.confidence) / std::sqrt(static_cast<double>(units));
  }
  MarginBands bands;
  std::vector<double> left(units);
  for (const std::vector<double>& scores : curve.scores) {
    for (std::size_t u = 0; u < units; ++u) left[u] = scores[u] - rule.fraction * undisturbed_of(curve, u);
    const double value = mean(left);
    const double half = units > 1 ? reach * sample_deviation(left) : 0.0;
    bands.value.push_back(value);
    bands.low.push_back(value - half);
    bands.high.push_back(value + half);
  }
  return bands;
}

double falling_bound(const MarginCurve& curve, const MarginRule& rule) {
  const std::size_t fallen = first_below(margin_bands(curve, rule).value);
  const std::vector<double> logs = falling_levels(curve, rule);
  if (fallen == curve.levels.size() || logs.size() < 2) return kInfinity;
  const auto n = static_cast<double>(logs.size());
  const double share = std::min(0.5, losing_share(curve, fallen));
  const double noncentrality = -boost::math::quantile(boost::math::normal(), share) * std::sqrt(n);
  const double upper = 0.5 + 0.5 * rule.confidence;
  const double reach = noncentrality > 0
                           ? boost::math::quantile(boost::math::non_central_t(n - 1, noncentrality), upper)
                           : boost::math::quantile(boost::math::students_t(n - 1), upper);
  return exp(mean(logs) - reach / std::sqrt(n) * sample_deviation(logs));
}

Margin margin(const MarginCurve& curve, const MarginRule& rule) {
  check_curve(curve);
  const auto finite = [](const std::vector<double>& scores) { return all_finite(scores); };
  if (!finite(curve.undisturbed) || !std::ranges::all_of(curve.scores, finite))
    return no_margin("a score is not finite");
  if (!(mean(curve.undisturbed) > 0)) return no_margin("the undisturbed score is not positive");

  const MarginBands bands = margin_bands(curve, rule);
  const std::vector<double>& levels = curve.levels;
  Margin result;
  result.last_level = levels.back();
  result.level.unit = curve.scores.front().size() > 1 ? curve.unit : Unit::none;
  result.level.n = curve.scores.front().size();
  const std::size_t i = first_below(bands.value);
  result.censored = i == levels.size();
  result.at_most = (i == 0 && levels.front() > 0) || (i == 1 && !result.censored && is_smallest(levels));
  if (result.censored) {
    result.level.estimate = result.last_level;
  } else if (i == 0 || result.at_most) {
    result.level.estimate = levels[i];
  } else {
    result.level.estimate = rule.interpolated
                                ? crossing_between(levels[i - 1], levels[i], bands.value[i - 1], bands.value[i], 0.0)
                                : levels[i];
  }
  if (result.level.unit == Unit::none) return result;
  const std::size_t low = first_below(bands.low), high = first_below(bands.high);
  const auto falling = std::ranges::lower_bound(levels, falling_bound(curve, rule)) - levels.begin();
  const std::size_t before = std::min(low, static_cast<std::size_t>(falling));
  result.level.low = before == levels.size() ? result.last_level : before == 0 ? 0.0 : levels[before - 1];
  result.level.high = high == levels.size() ? kInfinity : levels[high];
  return result;
}

Margin no_margin(std::string reason) {
  Margin none;
  none.reason = std::move(reason);
  return none;
}

std::string margin_text(const Margin& margin) {
  const Interval& level = margin.level;
  if (std::isnan(level.estimate)) return "–";
  std::string estimate = level_text(margin.censored ? kInfinity : level.estimate, margin.last_level);
  if (margin.at_most) estimate = cat("≤ ", estimate);
  const bool nothing_more = std::isnan(level.low) || (margin.censored && level.low == margin.last_level) ||
                            (margin.at_most && level.high <= level.estimate);
  if (nothing_more) return estimate;
  return cat(estimate, " [", level_text(level.low, margin.last_level), ", ", level_text(level.high, margin.last_level),
             "]");
}

std::vector<double> margin_scores(const Cell& cell) {
  Matrix<double> counted(cell.rows, cell.lanes);
  for (std::size_t seed = 0; seed < cell.rows; ++seed) {
    for (std::size_t episode = 0; episode < cell.lanes; ++episode) {
      const double score = cell.at(seed, episode);
      counted.at(seed, episode) = std::isnan(score) ? 0.0 : score;
    }
  }
  return unit_values(counted.view());
}

std::vector<double> areas(const Curve& curve) {
  check_curve(curve);
  const double range = curve.levels.back() - curve.levels.front();
  std::vector<double> before = margin_scores(curve.cells.front());
  if (curve.levels.size() == 1) return before;
  std::vector<double> result(before.size(), 0.0);
  for (std::size_t i = 1; i < curve.levels.size(); ++i) {
    const std::vector<double> scores = margin_scores(curve.cells[i]);
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
