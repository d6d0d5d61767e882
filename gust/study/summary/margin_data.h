#pragma once

#include <memory>
#include <span>

#include "gust/stats/sampled_margin.h"
#include "gust/store/store.h"
#include "gust/study/plan/plan.h"

namespace gust {

/// A policy along a sweep from a start.
struct SweepOf {
  std::size_t policy, sweep, start;
};

/// The random numbers of comparisons of two policies in a study.
Rng comparison_stream(const Study& study);

/// Reads what margins of a study are told from.
struct MarginReader {
  const Study& study;
  const Plan& plan;
  const Store& store;

  /// The scores of a metric undisturbed, at the study's levels, and at those that the margin's trial looked at; of
  /// these members only, if there are some. Null where the members in the store are not the same ones everywhere.
  std::shared_ptr<const MarginData> read(const SweepOf& of, const std::string& metric,
                                         std::span<const std::size_t> members = {}) const;
};

}  // namespace gust
