#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "gust/core/error.h"
#include "gust/stats/compare.h"
#include "gust/stats/resampled_mean.h"
#include "gust/stats/share.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

constexpr std::size_t kResamples = 2'000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What the resamples of a mean have to be stretched by so that their 95 % interval is Student's: they deviate too
/// little by sqrt((n - 1) / n), and the normal distribution takes the place of t.
double stretch(std::size_t n) {
  const auto units = static_cast<double>(n);
  const boost::math::students_t student(units - 1.0);
  constexpr double kNormal = 1.959963984540054;
  return boost::math::quantile(student, 0.975) / kNormal * std::sqrt(units / (units - 1.0));
}

/// One policy's curve as its units have it: [level][seed] averaged over episodes, and [level][episode] over seeds.
struct UnitCurves {
  std::vector<double> levels;
  std::vector<double> means;  ///< by level
  std::vector<std::vector<double>> seeds;
  std::vector<std::vector<double>> episodes;
};

void add_cell(const Cell& cell, UnitCurves& result) {
  std::vector<double> seeds(cell.rows, 0.0), episodes(cell.lanes, 0.0);
  for (std::size_t seed = 0; seed < cell.rows; ++seed) {
    for (std::size_t episode = 0; episode < cell.lanes; ++episode) {
      const double score = std::isfinite(cell.at(seed, episode)) ? cell.at(seed, episode) : 0.0;
      seeds[seed] += score / static_cast<double>(cell.lanes);
      episodes[episode] += score / static_cast<double>(cell.rows);
    }
  }
  result.means.push_back(mean(seeds));
  result.seeds.push_back(std::move(seeds));
  result.episodes.push_back(std::move(episodes));
}

UnitCurves unit_curves(const Curve& curve) {
  UnitCurves result{{curve.levels.begin(), curve.levels.end()}, {}, {}, {}};
  for (const Cell& cell : curve.cells) add_cell(cell, result);
  return result;
}

/// The same behind the undisturbed scores, which belong to no level.
UnitCurves unit_curves(const MarginCells& margin) {
  UnitCurves result{{margin.curve.levels.begin(), margin.curve.levels.end()}, {}, {}, {}};
  add_cell(margin.undisturbed, result);
  for (const Cell& cell : margin.curve.cells) add_cell(cell, result);
  return result;
}

/// The curve of one policy in each resample: [level][resample].
using Resampled = std::vector<std::vector<double>>;

Resampled constant(const UnitCurves& curve) {
  Resampled result;
  for (const double value : curve.means) result.emplace_back(kResamples, value);
  return result;
}

Resampled resampled(const std::vector<std::vector<double>>& units, Bootstrap& bootstrap) {
  Resampled result(units.size(), std::vector<double>(kResamples));
  std::vector<GroupedValues> prepared;
  for (const std::vector<double>& values : units) prepared.emplace_back(values);
  const std::size_t strata[] = {prepared.front().groups()};
  bootstrap.for_each_block(strata, [&](std::size_t first, const Rows<const std::uint16_t>& times) {
    for (std::size_t level = 0; level < units.size(); ++level)
      prepared[level].resampled_means(times, std::span(result[level]).subspan(first, times.lanes));
  });
  return result;
}

/// One way in which data could have come out otherwise: other seeds of a policy, or other episodes of both.
struct Source {
  Unit unit = Unit::none;
  std::size_t n = 0;
  Resampled a, b;
};

std::vector<Source> sources_of(const UnitCurves& a, const UnitCurves& b, const Rng& rng) {
  std::vector<Source> sources;
  const std::size_t seeds_a = a.seeds.front().size(), seeds_b = b.seeds.front().size();
  const std::size_t episodes = a.episodes.front().size();
  if (seeds_a > 1) {
    Bootstrap draws(rng.split("seeds of a"), kResamples);
    sources.push_back({Unit::seeds, seeds_a, resampled(a.seeds, draws), constant(b)});
  }
  if (seeds_b > 1) {
    Bootstrap draws(rng.split("seeds of b"), kResamples);
    sources.push_back({Unit::seeds, seeds_b, constant(a), resampled(b.seeds, draws)});
  }
  if (episodes > 1) {
    Bootstrap draws(rng.split("episodes"), kResamples);
    sources.push_back({Unit::episodes, episodes, resampled(a.episodes, draws), resampled(b.episodes, draws)});
  }
  return sources;
}

/// A number with what each source makes of it.
struct Varied {
  double estimate = 0;
  std::vector<std::vector<double>> by_source;  ///< [source][resample]
};

/// The number of each resample: what the sources change adds up.
std::vector<double> added(const Varied& number, std::span<const Source> sources) {
  std::vector<double> total(kResamples, number.estimate);
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const double factor = stretch(sources[s].n);
    for (std::size_t k = 0; k < kResamples; ++k) {
      const double value = number.by_source[s][k];
      if (value != number.estimate) total[k] += factor * (value - number.estimate);
    }
  }
  return total;
}

double variance_of(const std::vector<double>& values, double center) {
  double sum = 0;
  for (const double value : values) sum += (value - center) * (value - center);
  return sum / static_cast<double>(values.size());
}

/// The source whose spread weighs most.
const Source& heaviest(const Varied& number, std::span<const Source> sources, double& share) {
  std::size_t most = 0;
  std::vector<double> weights;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const double factor = stretch(sources[s].n);
    weights.push_back(factor * factor * variance_of(number.by_source[s], number.estimate));
    if (weights[s] > weights[most]) most = s;
  }
  double total = 0;
  for (const double weight : weights) total += weight;
  share = total > 0 ? weights[most] / total : 1.0;
  return sources[most];
}

PairedDifference difference(const Varied& number, std::span<const Source> sources) {
  PairedDifference result{.interval = {.estimate = number.estimate}};
  if (sources.empty()) return result;
  std::vector<double> values = added(number, sources);
  Bootstrap(Rng(0), kResamples).bound(result.interval, values);
  double share = 1.0;
  const Source& source = heaviest(number, sources, share);
  result.unit = result.interval.unit = source.unit;
  result.interval.n = source.n;
  const Interval& found = result.interval;
  if (standing(found) != Standing::undecided) {
    result.needed = 1.0;
    return result;
  }
  const double width = found.estimate < 0 ? found.high - found.estimate : found.estimate - found.low;
  const double factor = (width / found.estimate) * (width / found.estimate);
  // The rest of the spread stays: share / m + (1 - share) = 1 / factor.
  const double left = 1.0 / factor - (1.0 - share);
  if (found.estimate == 0.0)
    result.needed = kInfinity;
  else if (left > 0.0)
    result.needed = share / left * static_cast<double>(source.n);
  return result;
}

/// The mean over the levels, by the trapezoidal rule.
double area_of(std::span<const double> levels, std::span<const double> scores) {
  if (levels.size() == 1) return scores.front();
  double sum = 0;
  for (std::size_t i = 1; i < levels.size(); ++i)
    sum += 0.5 * (levels[i] - levels[i - 1]) * (scores[i] + scores[i - 1]);
  return sum / (levels.back() - levels.front());
}

/// A level that both curves have, by its place in each.
struct Common {
  double level;
  std::size_t in_a, in_b;
};

std::vector<Common> common_levels(const UnitCurves& a, const UnitCurves& b) {
  std::vector<Common> common;
  for (std::size_t i = 0; i < a.levels.size(); ++i) {
    const auto at = std::ranges::find(b.levels, a.levels[i]);
    if (at != b.levels.end()) common.push_back({a.levels[i], i, static_cast<std::size_t>(at - b.levels.begin())});
  }
  return common;
}

void add_scores(const UnitCurves& a, const UnitCurves& b, std::span<const Source> sources, Comparison& result) {
  std::vector<Varied> at;
  std::vector<double> estimates;
  for (const Common& common : common_levels(a, b)) {
    result.levels.push_back(common.level);
    Varied& number = at.emplace_back(Varied{a.means[common.in_a] - b.means[common.in_b], {}});
    estimates.push_back(number.estimate);
    for (const Source& source : sources) {
      std::vector<double>& values = number.by_source.emplace_back(kResamples);
      for (std::size_t k = 0; k < kResamples; ++k) values[k] = source.a[common.in_a][k] - source.b[common.in_b][k];
    }
    result.scores.push_back(difference(number, sources));
  }
  if (at.empty()) return;
  Varied over{area_of(result.levels, estimates), {}};
  std::vector<double> scores(at.size());
  for (std::size_t s = 0; s < sources.size(); ++s) {
    std::vector<double>& values = over.by_source.emplace_back(kResamples);
    for (std::size_t k = 0; k < kResamples; ++k) {
      for (std::size_t i = 0; i < at.size(); ++i) scores[i] = at[i].by_source[s][k];
      values[k] = area_of(result.levels, scores);
    }
  }
  result.over = difference(over, sources);
}

/// The logarithm of a ratio of margins, as far as it is known. The scores begin with the undisturbed one. In a resample
/// that fails undisturbed there is nothing to lose: its margin is 0.
Bounds log_ratio(const UnitCurves& a, const UnitCurves& b, const MarginRule& rule, std::span<const double> scores_a,
                 std::span<const double> scores_b) {
  const auto margin = [&](const UnitCurves& curve, std::span<const double> scores) {
    const Bounds level = crossing(curve.levels, scores.subspan(1), scores.front(), rule);
    return std::isnan(level.low) ? Bounds(0.0) : level;
  };
  const Bounds of_a = margin(a, scores_a), of_b = margin(b, scores_b);
  return {std::log(of_a.low / of_b.high), std::log(of_a.high / of_b.low)};
}

/// A change of an end, also where it stays infinite.
double change(double value, double estimate) { return value == estimate ? 0.0 : value - estimate; }

/// The ratio of each resample at both of its ends; what the sources change adds up.
void draw_ratio(const UnitCurves& a, const UnitCurves& b, const MarginRule& rule, std::span<const Source> sources,
                Sampled& ratio) {
  const Bounds estimate = log_ratio(a, b, rule, a.means, b.means);
  std::vector<double> low(kResamples, estimate.low), high(kResamples, estimate.high);
  std::vector<double> scores_a(a.means.size()), scores_b(b.means.size());
  for (const Source& source : sources) {
    const double factor = stretch(source.n);
    for (std::size_t k = 0; k < kResamples; ++k) {
      for (std::size_t i = 0; i < scores_a.size(); ++i) scores_a[i] = source.a[i][k];
      for (std::size_t i = 0; i < scores_b.size(); ++i) scores_b[i] = source.b[i][k];
      const Bounds drawn = log_ratio(a, b, rule, scores_a, scores_b);
      low[k] += factor * change(drawn.low, estimate.low);
      high[k] += factor * change(drawn.high, estimate.high);
    }
  }
  ratio.values.resize(1 + kResamples);
  if (!ratio.upper.empty()) ratio.upper.resize(1 + kResamples);
  for (std::size_t k = 0; k < kResamples; ++k)
    ratio.set(1 + k,
              {std::isnan(low[k]) ? 0.0 : std::exp(low[k]), std::isnan(high[k]) ? kInfinity : std::exp(high[k])});
}

double win(double x, double y) { return x > y ? 1.0 : x == y ? 0.5 : 0.0; }

/// The share of pairs that each unit of a wins, averaged over the levels: against all seeds of b, or in the same
/// episode.
std::vector<double> wins_of(const UnitCurves& a, const UnitCurves& b, bool by_seeds, bool swapped) {
  const std::vector<Common> common = common_levels(a, b);
  const auto& units_a = by_seeds ? a.seeds : a.episodes;
  const auto& units_b = by_seeds ? b.seeds : b.episodes;
  std::vector<double> wins((swapped ? units_b : units_a).front().size(), 0.0);
  for (const Common& at : common) {
    const std::vector<double>&x = units_a[at.in_a], &y = units_b[at.in_b];
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t j = by_seeds ? 0 : i; j < (by_seeds ? y.size() : i + 1); ++j) {
        const double pairs = static_cast<double>(by_seeds ? (swapped ? x.size() : y.size()) : 1);
        wins[swapped ? j : i] += win(x[i], y[j]) / pairs / static_cast<double>(common.size());
      }
    }
  }
  return wins;
}

void add_improvement(const UnitCurves& a, const UnitCurves& b, const Rng& rng, Comparison& result) {
  if (result.levels.empty()) return;
  const bool by_seeds = a.seeds.front().size() > 1 || b.seeds.front().size() > 1;
  const std::vector<double> of_a = wins_of(a, b, by_seeds, false), of_b = wins_of(a, b, by_seeds, true);
  Interval& share = result.improvement;
  share = {.estimate = mean(of_a), .unit = by_seeds ? Unit::seeds : Unit::episodes};
  std::vector<double> values(kResamples, share.estimate);
  const auto vary = [&](const std::vector<double>& wins, std::string_view purpose) {
    if (wins.size() < 2) return;
    share.n = share.n == 0 ? wins.size() : std::min(share.n, wins.size());
    Bootstrap draws(rng.split("improvement").split(purpose), kResamples);
    const std::vector<double> drawn = resampled({wins}, draws).front();
    for (std::size_t k = 0; k < kResamples; ++k) values[k] += stretch(wins.size()) * (drawn[k] - share.estimate);
  };
  vary(of_a, "a");
  if (by_seeds) vary(of_b, "b");
  if (share.n == 0) {
    share.unit = Unit::none;
    return;
  }
  const double clipped = std::clamp(share.estimate, 0.0, 1.0), units = static_cast<double>(share.n);
  share.estimate = clipped;
  share.low = std::clamp(std::min(quantile_reordering(values, 0.025), wilson_end(clipped, units, 0.025)), 0.0, 1.0);
  share.high = std::clamp(std::max(quantile_reordering(values, 0.975), wilson_end(clipped, units, 0.975)), 0.0, 1.0);
}

}  // namespace

Standing standing(const Interval& difference) {
  if (difference.low > 0.0) return Standing::ahead;
  return difference.high < 0.0 ? Standing::behind : Standing::undecided;
}

Comparison compare(const Curve& a, const Curve& b, const Rng& rng) {
  GUST_CHECK(!a.cells.empty() && !b.cells.empty() && a.cells.front().lanes == b.cells.front().lanes);
  const UnitCurves curve_a = unit_curves(a), curve_b = unit_curves(b);
  const std::vector<Source> sources = sources_of(curve_a, curve_b, rng);
  Comparison result;
  add_scores(curve_a, curve_b, sources, result);
  add_improvement(curve_a, curve_b, rng, result);
  return result;
}

Sampled sampled_margin_ratio(const MarginCells& a, const MarginCells& b, const MarginRule& rule, const Rng& rng) {
  GUST_CHECK(!a.curve.cells.empty() && !b.curve.cells.empty() && a.undisturbed.lanes == b.undisturbed.lanes);
  const UnitCurves curve_a = unit_curves(a), curve_b = unit_curves(b);
  const Bounds estimate = log_ratio(curve_a, curve_b, rule, curve_a.means, curve_b.means);
  Sampled ratio = Sampled::constant(std::numeric_limits<double>::quiet_NaN());
  const bool any = !std::isnan(estimate.low) && !std::isnan(estimate.high);
  if (!any || !(curve_a.means.front() > 0.0) || !(curve_b.means.front() > 0.0)) return ratio;
  ratio.set(
      0, estimate.exact() ? Bounds(std::exp(estimate.low)) : Bounds(std::exp(estimate.low), std::exp(estimate.high)));
  const std::vector<Source> sources = sources_of(curve_a, curve_b, rng);
  if (sources.empty()) return ratio;
  for (const Source& source : sources) {
    if (ratio.n == 0 || source.n < ratio.n) ratio.n = source.n;
    ratio.unit = std::max(ratio.unit, source.unit);
  }
  draw_ratio(curve_a, curve_b, rule, sources, ratio);
  return ratio;
}

Interval margin_ratio(const MarginCells& a, const MarginCells& b, const MarginRule& rule, const Rng& rng) {
  const Sampled ratio = sampled_margin_ratio(a, b, rule, rng);
  Interval interval = interval_of(ratio);
  if (ratio.is_constant()) interval.low = interval.high = std::numeric_limits<double>::quiet_NaN();
  return interval;
}

}  // namespace gust
