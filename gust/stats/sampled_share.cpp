#include "gust/stats/sampled_share.h"

#include <algorithm>
#include <numeric>

#include "gust/stats/share.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

/// Half a success and half a failure, as Jeffreys' prior of a share has them, each a gamma variable of shape 1/2: half
/// of a squared normal one. They order resamples with equally many successes.
double with_prior(double share, double trials, const Rng& rng, std::size_t k) {
  const double success = rng.normal(2 * k), failure = rng.normal(2 * k + 1);
  const double more = 0.5 * success * success;
  return (share * trials + more) / (trials + more + 0.5 * failure * failure);
}

}  // namespace

Sampled sampled_share(Sampled share, std::size_t trials, const Rng& together, const Rng& alone) {
  const std::size_t resamples = share.values.size() - 1;
  const auto count = static_cast<double>(trials);
  share.is_share = true;
  share.at_ends = share.estimate() == 0.0 || share.estimate() == 1.0;
  std::vector<double> drawn(share.values.begin() + 1, share.values.end());
  std::vector<double> key(resamples);
  for (std::size_t k = 0; k < resamples; ++k) key[k] = with_prior(drawn[k], count, k % 2 == 0 ? together : alone, k);
  std::vector<std::size_t> order(resamples);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return std::pair(key[k], k); });

  std::ranges::sort(drawn);
  for (std::size_t rank = 0; rank < resamples; ++rank) {
    const double tail = static_cast<double>(rank) / static_cast<double>(resamples - 1);
    double& value = share.values[1 + order[rank]];
    value = wilson_end(share.estimate(), count, tail);
    if (share.unit == Unit::seeds) value = tail < 0.5 ? std::min(value, drawn[rank]) : std::max(value, drawn[rank]);
  }
  return share;
}

}  // namespace gust
