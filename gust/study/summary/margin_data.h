#pragma once

#include <memory>
#include <span>

#include "gust/stats/sampled_margin.h"
#include "gust/study/summary/measurements.h"

namespace gust {

/// A policy along a sweep from a start.
struct SweepOf {
  std::size_t policy, sweep, start;
};

/// The random numbers of comparisons of two policies in a study.
Rng comparison_stream(const Study& study);

/// What margins are told from: the scores of a metric undisturbed, at the study's levels, and at those that were looked
/// at beside them; of these members only, if there are some. Null where the members are not the same ones everywhere.
std::shared_ptr<const MarginData> read_margin_data(const Measurements& measured, const SweepOf& of,
                                                   const std::string& metric,
                                                   std::span<const std::size_t> members = {});

}  // namespace gust
