#pragma once

#include <memory>

#include "gust/sim/distribution.h"

namespace gust {

/// A distribution of options: `Options` has kFields, check(place), least(), greatest() and draw(rng).
template <class Options>
class OptionsDistribution final : public Distribution {
 public:
  explicit OptionsDistribution(const Options& options) : options_(options) {}
  double low() const override { return options_.least(); }
  double high() const override { return options_.greatest(); }
  double draw(const Rng& rng) const override { return options_.draw(rng); }

 private:
  Options options_;
};

template <class Options>
Entry<Distribution> distribution_entry(std::string name, std::string summary) {
  return make_entry<Distribution, Options>(
      std::move(name), std::move(summary), "gust (docs/disturbances.md 5)",
      [](const Options& options) { return std::make_unique<OptionsDistribution<Options>>(options); });
}

/// An Error unless low <= high.
inline void check_order(double low, double high, const Place& place) {
  if (low <= high) return;
  throw error_at(place, "'low' must be at most 'high', got ", low, " and ", high);
}

}  // namespace gust
