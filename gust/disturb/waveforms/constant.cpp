#include <algorithm>

#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

struct Constant {
  static constexpr std::tuple<> kFields = {};

  void fill(std::span<double> out, double, Rng) const { std::fill(out.begin(), out.end(), 1.0); }
};

}  // namespace

Entry<Waveform> waveform_constant() {
  return waveform_entry<Constant>("constant", "The level at every control step: a bias.", "gust");
}

}  // namespace gust
