#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "gust/core/rng.h"
#include "gust/core/rows.h"
#include "gust/stats/interval.h"

namespace gust {

/// The share of resamples to leave out at each end where units are few: instead of (1 - confidence) / 2, which makes
/// percentile intervals of a mean too narrow by sqrt((n - 1) / n) and by Student's t against the normal distribution
/// (Hesterberg, What Teachers Should Know About the Bootstrap, 2015). Of normal samples what is called 95 % then covers
/// 92 % with five units and 94 % with ten, instead of 84 % and 90 %. At least two units.
double widened_tail(std::size_t units, double confidence = 0.95);

/// The percentile bootstrap: which units are drawn in each resample, and the interval that follows.
///
/// Units come in strata; a resample draws from each stratum, with replacement and independently, as many units as it
/// has (rliable's stratified bootstrap). Of more than kMostGroups units neighbours are drawn together, in groups of
/// equal size, and the few that are left over stay: the spread of a mean is the same, and a cell of 600,000 episodes
/// takes seconds. Equal strata always meet the same draws, whatever was asked before: so equal data give equal bits in
/// any order of questions, and the draws of a common shape are made once. An object serves one thread.
class Bootstrap {
 public:
  static constexpr std::size_t kBlock = 512;        ///< most resamples that are looked at together
  static constexpr std::size_t kLeastBlock = 16;    ///< and fewest, of many units
  static constexpr std::size_t kMostGroups = 8192;  ///< most units of a stratum that are drawn one by one

  /// How many neighbours are drawn together where a stratum has that many units. Whoever averages them first asks for
  /// as many strata as there are groups, and gets the same draws.
  static std::size_t group_size(std::size_t units);

  explicit Bootstrap(Rng rng, std::size_t resamples = 10'000, double confidence = 0.95);

  std::size_t resamples() const { return resamples_; }
  double confidence() const { return confidence_; }

  /// Calls visit(first, times) for consecutive blocks of resamples: times.at(unit, k) says how often a unit is drawn in
  /// resample first + k; times.lanes is at most kBlock. Units are numbered through all strata.
  template <class Visit>
  void for_each_block(std::span<const std::size_t> strata, Visit&& visit);

  /// Sets low and high to the two percentiles of what the resamples gave, and reorders that. Infinity is allowed, NaN
  /// not.
  void bound(Interval& interval, std::span<double> resampled) const;

 private:
  using Times = Matrix<std::uint16_t>;

  /// The draws of all resamples if the shape is small enough to keep, else null.
  const Times* kept(std::span<const std::size_t> strata);
  /// Counts the draws of resamples first, first + 1, … , one a lane.
  void draw(std::span<const std::size_t> strata, std::size_t first, Rows<std::uint16_t> times) const;

  Rng rng_;
  std::size_t resamples_;
  double confidence_;
  std::map<std::vector<std::size_t>, Times> kept_;
};

template <class Visit>
void Bootstrap::for_each_block(std::span<const std::size_t> strata, Visit&& visit) {
  std::size_t units = 0;
  for (const std::size_t size : strata) units += size;
  const Times* all = kept(strata);
  constexpr std::size_t kMostCounts = std::size_t{1} << 22;  // 8 MB: of many units fewer resamples at a time
  const std::size_t block =
      all ? kBlock : std::clamp(kMostCounts / std::max<std::size_t>(units, 1), kLeastBlock, kBlock);
  Times scratch(all ? 0 : units, block);
  for (std::size_t first = 0; first < resamples_; first += block) {
    const std::size_t count = std::min(block, resamples_ - first);
    if (all) {
      const Rows<const std::uint16_t> times = all->view();
      visit(first, Rows<const std::uint16_t>{times.data + first, units, count, times.stride});
    } else {
      const Rows<std::uint16_t> times = scratch.view();
      const Rows<std::uint16_t> block{times.data, units, count, times.stride};
      draw(strata, first, block);
      visit(first, Rows<const std::uint16_t>(block));
    }
  }
}

}  // namespace gust
