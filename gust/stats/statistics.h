#pragma once

#include <cstddef>
#include <span>

namespace gust {

/// Statistics of a sample, as NumPy, SciPy and rliable define them. A NaN among the values gives NaN, and so does a
/// sample that is too small. Equal values give exactly that value, without rounding.

double mean(std::span<const double> values);

/// The standard deviation with n - 1 in the denominator; NaN for fewer than two values.
double sample_deviation(std::span<const double> values);

double median(std::span<const double> values);

/// The interquartile mean: the mean of what is left when floor(n / 4) values are dropped at each end
/// (scipy.stats.trim_mean with 0.25, rliable's aggregate_iqm).
double iqm(std::span<const double> values);

/// gamma - mean(min(value, gamma)): how far the values fall short of gamma on average (rliable).
double optimality_gap(std::span<const double> values, double gamma = 1.0);

/// The value below which a share q in [0, 1] of the sample lies, linear between two neighbours (NumPy's default).
double quantile(std::span<const double> values, double q);

/// The same without a copy: reorders the values, none of which may be NaN. Takes linear time.
double quantile_reordering(std::span<double> values, double q);

/// The mean of ascending values without the first and the last `drop`; at least one value must remain.
double trimmed_mean(std::span<const double> ascending, std::size_t drop);

bool all_finite(std::span<const double> values);

}  // namespace gust
