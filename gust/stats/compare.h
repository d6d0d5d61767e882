#pragma once

#include <limits>
#include <span>
#include <vector>

#include "gust/stats/bootstrap.h"
#include "gust/stats/interval.h"
#include "gust/stats/margin.h"

namespace gust {

/// P(X > Y) for one draw of each: the share of pairs in which x is larger, ties counting half. This is Mann and
/// Whitney's U / (n m). Identical samples give exactly 0.5. NaN if a value is NaN or a sample is empty.
double probability_of_improvement(std::span<const double> x, std::span<const double> y);

/// The same over the seeds of two policies, averaged over tasks (rliable), with the interval of a bootstrap that draws
/// the seeds of either policy in each task independently. x and y must have the same tasks. Where neither policy has
/// several seeds in a task, its episodes are compared and drawn instead.
Interval probability_of_improvement(std::span<const Cell> x, std::span<const Cell> y, Bootstrap& bootstrap);

/// A difference and what would decide its sign at the present spread.
struct PairedDifference {
  Interval interval;
  /// How many of `unit` would decide: of those whose spread weighs most, all else as it is. 1 where it is decided,
  /// infinite where the estimate is 0; NaN where more of one unit alone cannot decide.
  double needed = std::numeric_limits<double>::quiet_NaN();
  Unit unit = Unit::none;
};

enum class Standing { ahead, behind, undecided };

/// Where the sign of a difference is decided.
Standing standing(const Interval& difference);

/// Two policies along one sweep: a against b.
struct Comparison {
  std::vector<double> levels;            ///< that both curves have
  std::vector<PairedDifference> scores;  ///< at each of them, the mean score of a minus that of b
  PairedDifference over;                 ///< of the mean score over the levels (areas())
  Interval ratio;                        ///< margin_ratio(); NaN where it was not asked for or one has no margin
  Interval improvement;                  ///< the probability that a scores higher, averaged over the levels
};

/// Compares two policies that met the same episodes (lane e of both is the same start and the same noise).
///
/// Intervals are for other trainings and other episodes. The seeds of either policy are drawn independently, with their
/// whole curves; episodes are drawn for both policies together, so the luck that they share cancels. What the three
/// draws change adds up, each widened by Student's t for its number of units: a difference of two policies that are one
/// alone has the paired t interval. The probability of improvement is over pairs of seeds, or of two policies that are
/// one alone over episodes, pair by pair; it is never narrower than Wilson's interval of as many units.
///
/// Both curves must have the same lanes. Numbers that are not finite count as 0.
Comparison compare(const Curve& a, const Curve& b, const Rng& rng);

/// A curve from which a margin is told, with the undisturbed scores of the same seeds and episodes. Its levels may be
/// others than those of the curve that it is compared with.
struct MarginCells {
  Curve curve;
  Cell undisturbed;
};

/// The margin of a over that of b, with an interval as compare() has it. A margin beyond the levels, or below the first
/// one, is a bound, and so is the ratio. NaN where both are 0 or an undisturbed score is not positive.
Interval margin_ratio(const MarginCells& a, const MarginCells& b, const MarginRule& rule, const Rng& rng);
/// The same with its resamples, whose percentiles are that interval; a constant where there is none.
Sampled sampled_margin_ratio(const MarginCells& a, const MarginCells& b, const MarginRule& rule, const Rng& rng);

}  // namespace gust
