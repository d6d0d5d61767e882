#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gust/core/rows.h"

namespace gust {

/// Mean and variance of each row of all batches seen so far, merged batch by batch (Chan et al. 1979). The start, mean
/// 0 and variance 1, counts as 1e-4 of a sample.
struct RunningMoments {
  explicit RunningMoments(std::size_t rows) : mean(rows, 0.0), variance(rows, 1.0) {}

  std::vector<double> mean;
  std::vector<double> variance;
  double count = 1e-4;
};

/// Takes in one more batch.
void update_moments(RunningMoments& moments, Rows<const double> batch) noexcept;

/// to = (x - mean) / sqrt(variance + 1e-8), clipped to ±10; the moments stay as they are. `to` may be x.
void normalise(const RunningMoments& moments, Rows<const double> x, Rows<double> to) noexcept;

/// Scales the rewards of some environments by the spread of their discounted return so far.
struct RewardScale {
  explicit RewardScale(std::size_t environments) : moments(1), discounted(environments, 0.0) {}

  RunningMoments moments;
  std::vector<double> discounted;  ///< running discounted sum of each environment's episode
};

/// Takes in one step of every environment and scales its rewards in place: r / sqrt(variance + 1e-8), clipped to ±10,
/// not centred. Where `done`, the next step begins a new sum.
void scale_rewards(RewardScale& scale, double discount, std::span<const std::uint8_t> done,
                   std::span<double> reward) noexcept;

}  // namespace gust
