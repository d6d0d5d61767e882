#pragma once

#include <span>

#include "gust/eval/bootstrap.h"
#include "gust/eval/interval.h"

namespace gust {

/// P(X > Y) for one draw of each: the share of pairs in which x is larger, ties counting half. This is Mann and
/// Whitney's U / (n m). Identical samples give exactly 0.5. NaN if a value is NaN or a sample is empty.
double probability_of_improvement(std::span<const double> x, std::span<const double> y);

/// The same over the seeds of two policies, averaged over tasks (rliable), with the interval of a bootstrap that draws
/// the seeds of either policy in each task independently. x and y must have the same tasks. Where neither policy has
/// several seeds in a task, its episodes are compared and drawn instead.
Interval probability_of_improvement(std::span<const Cell> x, std::span<const Cell> y, Bootstrap& bootstrap);

/// The mean of a minus the mean of b, for two policies that met the same episodes (lane e of both is the same start and
/// the same noise), with the interval of the difference.
///
/// - Equally many seeds, more than one: row i of both is a pair. The episodes' differences are averaged within each
/// pair and
///   the pairs are drawn. What a pair shares (its seed's number) narrows the interval, and costs nothing if it is
///   nothing.
/// - Different numbers of seeds: each policy's seeds are drawn by themselves, over the same episodes on either side, so
/// that
///   the luck of those episodes cancels. A policy with one row is held fixed: right for one that was not trained; for
///   one training among many the interval speaks of that training.
/// - One row each: the differences of single episodes are drawn, and the unit is episodes.
Interval difference(const Cell& a, const Cell& b, Bootstrap& bootstrap);

}  // namespace gust
