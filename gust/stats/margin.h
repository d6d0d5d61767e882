#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "gust/stats/aggregate.h"
#include "gust/stats/bootstrap.h"
#include "gust/stats/interval.h"
#include "gust/stats/sampled.h"

namespace gust {

/// A robustness curve: the score of one policy against the level of one disturbance. Higher scores are better.
///
/// Levels ascend strictly, and the first one (0, or the lowest there is) is the nominal case. All cells have the same
/// seeds and the same episodes. A NaN counts as 0, the score of an episode that earns nothing.
struct Curve {
  std::span<const double> levels;
  std::span<const Cell> cells;
};

/// The first level at which the score falls below a fraction of the undisturbed score.
struct MarginRule {
  double fraction = 0.9;
  bool interpolated = true;  ///< where the straight line between two levels crosses, else the first level below
  double confidence = 0.95;  ///< of a margin's interval
};

/// L50: the smallest level of the grid with a score below half the nominal one.
inline constexpr MarginRule kHalfScore{.fraction = 0.5, .interpolated = false};

/// The smallest level that is looked at below a margin, as a share of the last level.
inline constexpr double kSmallestLevel = 1e-6;

/// What a margin is measured from: the scores of one policy along the levels of one disturbance, unit by unit (training
/// seeds where there are several, else episodes), and the undisturbed scores of the same units.
struct MarginCurve {
  std::vector<double> levels;               ///< ascending strictly, none below 0
  std::vector<std::vector<double>> scores;  ///< [level][unit]
  std::vector<double> undisturbed;          ///< one a unit, or one for all
  Unit unit = Unit::none;

  /// Adds the scores at a level in its place; a level that is there already is left as it is.
  void add(double level, std::vector<double> scores_there);
};

/// A margin in units of the level: the first level at which the mean score over the units falls below the rule's
/// fraction of the mean undisturbed score. docs/metrics.md has the definition, decision 4 the reasons.
///
/// An estimate or a low bound beyond the levels stands at the last level, a high bound at infinity: so comparing a
/// bound with a number says only what the data say.
struct Margin {
  Interval level;         ///< estimate NaN: there is no margin, and `reason` says why
  bool censored = false;  ///< nothing fell: the margin is at least the last level
  double last_level = std::numeric_limits<double>::quiet_NaN();
  bool at_most = false;     ///< the score has fallen at the smallest level looked at: the margin is at most that
  std::string reason = {};  ///< why there is none, or why it is 0
};

/// The level at which the scores along the levels fall below the rule's fraction of the undisturbed score, as far as
/// the levels tell: at least the last one where no score falls, between 0 and the first one where that has fallen
/// already (for a rule of levels alone it is the first). NaN if the undisturbed score is not positive.
Bounds crossing(std::span<const double> levels, std::span<const double> scores, double undisturbed,
                const MarginRule& rule);

/// Whether a nominal score is below the rule's fraction of the best one. Its margin is then a fall from less, and says
/// nothing against the others'. False where either score is not known or the best is not positive.
bool falls_short(double nominal, double best, const MarginRule& rule = {});

/// How much of the score is left above the threshold at each level: the mean over the units of
/// score - fraction * undisturbed, and the two ends of Student's interval of that mean. With one unit all are equal.
struct MarginBands {
  std::vector<double> value, low, high;
};
MarginBands margin_bands(const MarginCurve& curve, const MarginRule& rule);

/// A lower bound of the margin from where the units fall one by one, for curves that fall in steps: the scores of a few
/// units do not show a spread before the first of them falls, which a t-test takes for certainty. The levels at which
/// units fall are taken as lognormal; the bound is the tolerance limit (noncentral t) of that quantile of them which
/// carries the loss at the margin, the median at most. Infinite where there is nothing to be told from.
double falling_bound(const MarginCurve& curve, const MarginRule& rule);

/// The margin of a curve and its interval: all levels that a t-test at the rule's confidence does not exclude, down to
/// falling_bound(), out to the levels looked at on either side.
Margin margin(const MarginCurve& curve, const MarginRule& rule = {});

/// A margin that there is not.
Margin no_margin(std::string reason);

/// Levels to look at next, ascending, so that the margin does not depend on the levels chosen so far; empty when
/// neighbours around the margin and around both ends of its interval are at most `tolerance` margins apart, and no step
/// below them is wider than a factor of 1.25, down to a hundredth of the lowest of them (a millionth of the last level,
/// as long as even the smallest level lies beyond the crossing). A pure function of its arguments.
std::vector<double> next_margin_levels(const MarginCurve& curve, const MarginRule& rule, double tolerance);

/// "5.2 [4.9, 5.6]", "≥ 15", "12 [10, ≥ 15]", "≤ 0.001", or "–" where there is no margin; to three significant digits.
std::string margin_text(const Margin& margin);

/// The area under each unit's curve (seed, or episode of a single seed), by the trapezoidal rule, divided by the range
/// of the levels: the mean score over the range. One level gives the score there. Such values can be compared as a
/// Cell.
std::vector<double> areas(const Curve& curve);

/// The mean area with its interval.
Interval area(const Curve& curve, Bootstrap& bootstrap);

/// One score a unit of a cell, as MarginCurve holds them: NaN counts as 0.
std::vector<double> margin_scores(const Cell& cell);

}  // namespace gust
