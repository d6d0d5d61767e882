#include "gust/sim/distribution_entry.h"

namespace gust {
namespace {

/// A normal distribution cut off at both ends, by rejection. With the mean inside, a proposal is taken with a
/// probability of at least 0.47: a normal one (number 0, 2, 4 … of the stream) where the range is wider than two
/// deviations, else a uniform one with the density's height.
struct Normal {
  double mean = 0.5;
  double deviation = 0.1;
  double low = 0.3;
  double high = 0.7;

  static constexpr std::tuple kFields = {
      field("mean", &Normal::mean, "where values are densest; between low and high"),
      field("deviation", &Normal::deviation, "standard deviation before the ends are cut off", positive),
      field("low", &Normal::low, "least value"),
      field("high", &Normal::high, "greatest value"),
  };

  void check(const Place& place) const {
    check_order(low, high, place);
    if (mean < low || mean > high)
      throw error_at(place, "'mean' must lie between 'low' and 'high', got ", mean, " outside ", low, " to ", high);
  }
  double least() const { return low; }
  double greatest() const { return high; }

  double draw(const Rng& rng) const {
    constexpr std::uint64_t kTries = 200;  // all in vain with a probability below 1e-50
    const bool wide = high - low > 2.0 * deviation;
    for (std::uint64_t i = 0; i < 2 * kTries; i += 2) {
      const double value = wide ? mean + deviation * rng.normal(i) : low + (high - low) * rng.uniform(i);
      if (wide ? value >= low && value <= high : rng.uniform(i + 1) <= height(value)) return value;
    }
    return mean;
  }

  /// The density over its greatest value.
  double height(double value) const {
    const double z = (value - mean) / deviation;
    return exp(-0.5 * z * z);
  }
};

}  // namespace

Entry<Distribution> distribution_normal() {
  return distribution_entry<Normal>("normal", "About the mean, cut off at low and high.");
}

}  // namespace gust
