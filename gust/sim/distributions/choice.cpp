#include <algorithm>

#include "gust/sim/distribution_entry.h"

namespace gust {
namespace {

struct Choice {
  std::vector<double> values = {1.0};

  static constexpr std::tuple kFields = {
      field("values", &Choice::values, "the values; one that is listed twice is twice as likely"),
  };

  void check(const Place& place) const {
    if (values.empty()) throw error_at(place, "'values' must have at least one number");
  }
  double least() const { return *std::ranges::min_element(values); }
  double greatest() const { return *std::ranges::max_element(values); }
  double draw(const Rng& rng) const { return values[rng.below(values.size(), 0)]; }
};

}  // namespace

Entry<Distribution> distribution_choice() {
  return distribution_entry<Choice>("choice", "One of a list of values, all equally likely.");
}

}  // namespace gust
