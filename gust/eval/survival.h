#pragma once

#include <cstddef>

#include "gust/eval/bootstrap.h"
#include "gust/eval/interval.h"

namespace gust {

/// Wilson's score interval of a proportion, without continuity correction (Wilson 1927; scipy.stats.binomtest). Takes
/// the trials as independent, and keeps its width where all succeed or none does. The unit is episodes.
Interval wilson(std::size_t successes, std::size_t trials, double confidence = 0.95);

/// The share of episodes that survived; a value is 1 for survival, anything else (NaN too) counts as a failure.
///
/// One seed: Wilson's interval over its episodes. Several seeds: episodes of one seed are alike, so Wilson's interval
/// over all episodes is too narrow when seeds differ, and the bootstrap over seeds has no width when none does. The
/// interval is the smallest that holds both; its unit is seeds.
Interval survival_interval(const Cell& survived, Bootstrap& bootstrap);

}  // namespace gust
