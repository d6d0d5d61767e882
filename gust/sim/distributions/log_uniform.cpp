#include <algorithm>

#include "gust/sim/distribution_entry.h"

namespace gust {
namespace {

struct LogUniform {
  double low = 0.1;
  double high = 1.0;

  static constexpr std::tuple kFields = {
      field("low", &LogUniform::low, "least value", positive),
      field("high", &LogUniform::high, "greatest value", positive),
  };

  void check(const Place& place) const { check_order(low, high, place); }
  double least() const { return low; }
  double greatest() const { return high; }
  double draw(const Rng& rng) const {
    const double value = exp(log(low) + (log(high) - log(low)) * rng.uniform(0));
    return std::clamp(value, low, high);  // exp and log round
  }
};

}  // namespace

Entry<Distribution> distribution_log_uniform() {
  return distribution_entry<LogUniform>(
      "log_uniform", "Between low and high, every factor equally likely: as often doubled as halved about the middle.");
}

}  // namespace gust
