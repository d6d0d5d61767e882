#pragma once

#include <span>

namespace gust {

// Correlations of pairs (x_i, y_i), -1 to 1, as SciPy defines them. NaN for fewer than two pairs, and where all x or
// all y are equal.

/// Pearson's r.
double pearson(std::span<const double> x, std::span<const double> y);

/// Spearman's rho: Pearson's r of the ranks; equal values share the mean of theirs.
double spearman(std::span<const double> x, std::span<const double> y);

/// Kendall's tau-b, which takes ties into account.
double kendall(std::span<const double> x, std::span<const double> y);

}  // namespace gust
