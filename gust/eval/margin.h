#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "gust/eval/aggregate.h"
#include "gust/eval/bootstrap.h"
#include "gust/eval/interval.h"

namespace gust {

/// A robustness curve: the score of one policy against the level of one disturbance. Higher scores are better.
///
/// Levels ascend strictly, and the first one (0, or the lowest there is) is the nominal case. All cells have the same
/// seeds and the same episodes. A NaN counts as 0, the score of an episode that earns nothing. For a swept parameter,
/// whose nominal value lies inside its range, take the levels as distances to either side.
struct Curve {
  std::span<const double> levels;
  std::span<const Cell> cells;
};

/// The first level at which the score falls below a fraction of the curve's own nominal score.
struct MarginRule {
  double fraction = 0.9;
  bool interpolated = true;  ///< where the straight line between two levels crosses, else the first level below
  Statistic statistic = Statistic::mean;  ///< of the seeds' scores at each level
};

/// L50 of the paper's claims: the smallest level of the grid with a score below half the nominal one.
inline constexpr MarginRule kHalfScore{.fraction = 0.5, .interpolated = false};

/// A margin in units of the level. A score that never falls that far makes it censored: all that is known is that the
/// margin is at least the last level.
///
/// An estimate or a low bound that is censored stands at the last level, a high bound at infinity: so comparing a bound
/// with a number says only what the data say. All is NaN if the nominal score is not positive.
struct Margin {
  Interval level;
  bool censored = false;
  double last_level = std::numeric_limits<double>::quiet_NaN();
};

/// The level at which the scores of a curve fall below the rule's fraction of the first one; infinite if they never do,
/// NaN if the first is not positive.
double crossing(std::span<const double> levels, std::span<const double> scores, const MarginRule& rule);

/// Whether a nominal score is below the rule's fraction of the best one. Its margin is then a fall from less, and says
/// nothing against the others'. False where either score is not known or the best is not positive.
bool falls_short(double nominal, double best, const MarginRule& rule = {});

/// The margin with its interval, over seeds or, for a single seed, over episodes. Seeds are drawn with their whole
/// curves. A resample whose nominal score is not positive counts as a margin at the first level.
Margin margin(const Curve& curve, const MarginRule& rule, Bootstrap& bootstrap);

/// "5.2 [4.9, 5.6]", "≥ 15", "12 [10, ≥ 15]", or "none" where there is no margin; to three significant digits.
std::string margin_text(const Margin& margin);

/// The area under each unit's curve (seed, or episode of a single seed), by the trapezoidal rule, divided by the range
/// of the levels: the mean score over the range. One level gives the score there. Such values can be compared as a
/// Cell.
std::vector<double> areas(const Curve& curve);

/// The mean area with its interval.
Interval area(const Curve& curve, Bootstrap& bootstrap);

}  // namespace gust
