#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "gust/core/rows.h"

namespace gust {

/// The values of one metric of one policy in one situation: a row is a training seed, a lane an episode.
///
/// The training seed is the experimental unit and episodes are nested in it. A policy that was not trained, or of which
/// there is one training only, has one row. Lanes are episodes that may truly differ: where start and disturbance are
/// fixed, so that all episodes would be the same one, pass a single lane.
using Cell = Rows<const double>;

/// A cell over values that lie seed after seed; as many episodes each as there are values for.
inline Cell cell_of(std::span<const double> values, std::size_t seeds) {
  return {values.data(), seeds, values.size() / seeds, values.size() / seeds};
}

/// What an interval was resampled over, that is, what it lets you generalise to.
enum class Unit {
  none,      ///< there was one value only, so no interval
  episodes,  ///< other starts and noise, for this very policy
  seeds,     ///< other trainings of the same agent, on the same episodes
};

/// "seeds", "episodes" or "none".
std::string_view unit_name(Unit unit);

/// An estimate and its confidence interval. Where no interval exists (one value only, a value not finite), low and high
/// are NaN; whatever compares against them is then false.
struct Interval {
  double estimate = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
  Unit unit = Unit::none;
  std::size_t n = 0;  ///< how many units there were, in a comparison those of the smaller side that varies
  /// Where the estimate is known as a bound only, the greatest that it may be, infinite of a margin beyond the levels;
  /// else NaN.
  double most = std::numeric_limits<double>::quiet_NaN();
};

/// "0.953 [0.91, 0.987] (10 seeds)", "≥ 0.02 [≥ 0.02] (10 seeds)", to four significant digits; without the units where
/// they are of several kinds.
std::string interval_text(const Interval& interval);

}  // namespace gust
