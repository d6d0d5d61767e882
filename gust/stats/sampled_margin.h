#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gust/core/rng.h"
#include "gust/core/rows.h"
#include "gust/stats/compare.h"
#include "gust/stats/margin.h"
#include "gust/stats/sampled.h"

namespace gust {

/// The scores that a margin is told from: seeds x episodes undisturbed and at each level, those that the margin asked
/// for included.
struct MarginData {
  std::string policy = {};
  std::string measured = {};  ///< study, sweep, start and metric: two policies with the same ones can be compared
  Rng rng{0};                 ///< of comparisons in this study
  Matrix<double> undisturbed = {};
  std::vector<double> levels = {};  ///< ascending
  std::vector<Matrix<double>> scores = {};

  /// Adds the scores at a level in its place; a level that is there already is left as it is.
  void add(double level, Matrix<double> scores_there);
  /// The same unit by unit, as the table's margin is measured.
  MarginCurve curve() const;
};

/// A margin with resamples that have the interval of margin(), at any confidence: what a claim says of one margin has
/// the interval of the table. Percentiles of the resamples themselves are too narrow with few units (decision 4). Their
/// order stays, so what margins of one policy have in common cancels in a difference. As it is where there is one unit.
Sampled sampled_margin(Sampled drawn, std::shared_ptr<const MarginData> data);

/// margin_ratio() of what two margins were measured from.
Interval margin_ratio(const MarginData& a, const MarginData& b);

/// The ratio of two margins with that interval, of two policies under the same disturbance; nothing for others.
std::optional<Sampled> sampled_ratio(const Sampled& a, const Sampled& b);

/// The difference of the same two. It is positive in the resamples in which the ratio is above 1, so both say the same:
/// d = m log(a / b), with the logarithmic mean m = (a - b) / log(a / b) of the estimates. Nothing where one of the two
/// is known as a bound only, or is 0.
std::optional<Sampled> sampled_difference(const Sampled& a, const Sampled& b);

}  // namespace gust
