#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

struct Uniform {
  static constexpr bool kRandom = true;
  double low = -1.0;
  double high = 1.0;

  static constexpr std::tuple kFields = {
      field("low", &Uniform::low, "least value before the level"),
      field("high", &Uniform::high, "greatest value before the level"),
  };

  void check(const Place& place) const {
    if (low > high) throw error_at(place, "'low' must not be above 'high', got ", low, " and ", high);
  }

  void fill(std::span<double> out, double, Rng rng) const {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = low + (high - low) * rng.uniform(k);
  }
};

}  // namespace

Entry<Waveform> waveform_uniform() {
  return waveform_entry<Uniform>("uniform", "Independent uniform noise between low and high, scaled by the level.",
                                 "Glossop et al. 2022, supplement; docs/disturbances.md 3.1");
}

}  // namespace gust
