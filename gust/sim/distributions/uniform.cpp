#include "gust/sim/distribution_entry.h"

namespace gust {
namespace {

struct Uniform {
  double low = 0.1;
  double high = 1.0;

  static constexpr std::tuple kFields = {
      field("low", &Uniform::low, "least value"),
      field("high", &Uniform::high, "greatest value"),
  };

  void check(const Place& place) const { check_order(low, high, place); }
  double least() const { return low; }
  double greatest() const { return high; }
  double draw(const Rng& rng) const { return low + (high - low) * rng.uniform(0); }
};

}  // namespace

Entry<Distribution> distribution_uniform() {
  return distribution_entry<Uniform>("uniform", "Any value between low and high, all equally likely.");
}

}  // namespace gust
