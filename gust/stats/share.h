#pragma once

#include <cstddef>

#include "gust/stats/bootstrap.h"
#include "gust/stats/interval.h"

namespace gust {

/// Wilson's score interval of a proportion, without continuity correction (Wilson 1927; scipy.stats.binomtest). Takes
/// the trials as independent, and keeps its width where all succeed or none does. The unit is episodes.
Interval wilson(std::size_t successes, std::size_t trials, double confidence = 0.95);

/// The end of Wilson's interval that leaves `tail` of the confidence below it, of a share of that many trials: 0.025
/// gives the lower end at 95 %, 0.975 the upper one.
double wilson_end(double share, double trials, double tail);

/// From how many trials on Wilson's interval of a share leaves a bound out; infinite where the share is the bound.
double wilson_trials(double share, double bound, double confidence = 0.95);

/// A share of successes, such as the episodes that survived; a value is 1 for a success, anything else (NaN too) counts
/// as a failure.
///
/// One seed: Wilson's interval over its episodes. Several seeds: episodes of one seed are alike, so Wilson's interval
/// over all episodes is too narrow when seeds differ, and the bootstrap over seeds has no width when none does. The
/// interval is the smallest that holds both; its unit is seeds.
Interval share_interval(const Cell& successes, Bootstrap& bootstrap);

}  // namespace gust
