#pragma once

#include "gust/core/rows.h"
#include "gust/stats/interval.h"

namespace gust {

/// What each episode contributes to Q = mean(n) / mean(d) of its row (n numerator, d denominator of one seed, mean over
/// its episodes):
///
///     Q + (n_e - Q d_e) / mean(d)
///
/// The mean over a row is Q. The mean over resampled episodes is the quotient of the resampled means, numerator and
/// denominator together, to first order in their deviations (linearisation; Cochran, Sampling Techniques, 1977, 6.4).
/// Both cells must have the same shape.
Matrix<double> quotient_values(const Cell& numerator, const Cell& denominator);

}  // namespace gust
