#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

struct White {
  static constexpr bool kRandom = true;
  double std = 1.0;

  static constexpr std::tuple kFields = {field("std", &White::std, "standard deviation before the level", positive)};

  void fill(std::span<double> out, double, Rng rng) const {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = std * rng.normal(k);
  }
};

}  // namespace

Entry<Waveform> waveform_white() {
  return waveform_entry<White>("white", "Independent normal noise N(0, std^2); the level is its standard deviation.",
                               "Glossop et al. 2022, fig. 2a; docs/disturbances.md 3.1");
}

}  // namespace gust
