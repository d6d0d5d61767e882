#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gust/core/rows.h"

namespace gust {

/// Values prepared for the trimmed means of many resamples: sorted once, with the unit that each belongs to.
struct TrimmedValues {
  std::vector<double> ascending;
  std::vector<std::size_t> unit;  ///< ascending[i] was values[unit[i]]
  std::size_t drop = 0;           ///< how many to leave out at each end
};

/// Prepares finite values for means without `drop` values at each end; more than 2 drop values are needed.
TrimmedValues trimmed_values(std::span<const double> values, std::size_t drop);

/// Writes the trimmed mean of each resample into out[k]; times.at(unit, k) is how often a unit counts in resample k,
/// and adds up to the number of values. At most Bootstrap::kBlock lanes. Equal values give exactly that value.
void resampled_means(const TrimmedValues& values, const Rows<const std::uint16_t>& times, std::span<double> out);

/// Finite values as the bootstrap draws them: means of the groups of neighbours that are drawn together, which are the
/// values themselves where there are few (Bootstrap::group_size), and what is left over. A bootstrap that is asked for
/// groups() units draws what it would of all values, and an average takes no longer than of so many.
class GroupedValues {
 public:
  explicit GroupedValues(std::span<const double> values);

  std::size_t groups() const { return drawn_.ascending.size(); }
  /// The mean of all values in each resample; times.at(group, k) is how often a group counts.
  void resampled_means(const Rows<const std::uint16_t>& times, std::span<double> out) const;

 private:
  std::size_t total_, size_;
  double left_over_ = 0;
  TrimmedValues drawn_;
};

}  // namespace gust
