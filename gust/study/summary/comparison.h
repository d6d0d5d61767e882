#pragma once

#include "gust/stats/compare.h"
#include "gust/study/summary/summary.h"

namespace gust {

/// What is asked: one policy of a study against another from one start.
struct PolicyPair {
  std::size_t a = 0;
  std::size_t b = 0;
  std::size_t start = 0;
};

/// Two policies along one sweep, or undisturbed: the scores are those of the margins (margin_metric).
struct SweepComparison {
  PolicyPair pair;
  std::size_t sweep = Trial::kNominal;
  Comparison found;
  std::size_t seeds = 0;  ///< the fewest of the two that has seeds; 0 if neither has
  bool repeats = false;   ///< every episode is the same one

  /// Fewer than kSeedsForVerdict seeds decide nothing.
  Standing standing_of(const Interval& difference) const;
  /// How many of the levels have this standing.
  std::size_t count(Standing wanted) const;
  /// What would decide the difference over the levels: "about 40 episodes would decide"; empty where it is decided.
  /// More episodes are never that where all are the same one.
  std::string needed() const;
};

/// The undisturbed score and every sweep in the order of the study; for grids the levels are numbers of cells. What is
/// not in the store is left out. Equal trials give equal bits.
std::vector<SweepComparison> compare_policies(const Measurements& measured, const PolicyPair& pair);

/// The pairs that a page shows: all of up to six policies, else each with the first, from a start.
std::vector<PolicyPair> shown_pairs(const Study& study, std::size_t start);

/// The start whose episodes differ, on which comparisons are: the first that is random, else the first.
std::size_t compared_start(const Study& study);

/// All of them, by several threads.
std::vector<SweepComparison> compare_pairs(const Measurements& measured, const std::vector<PolicyPair>& pairs,
                                           std::size_t threads);

}  // namespace gust
