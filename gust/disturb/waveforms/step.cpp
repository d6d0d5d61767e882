#include "gust/disturb/waveform_entry.h"

namespace gust {
namespace {

struct Step {
  std::int64_t offset = 2;

  static constexpr std::tuple kFields = {
      field("offset", &Step::offset, "first control step that is disturbed", non_negative, "control steps")};

  void fill(std::span<double> out, double, Rng) const {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<std::int64_t>(k) >= offset ? 1.0 : 0.0;
  }
};

}  // namespace

Entry<Waveform> waveform_step() {
  return waveform_entry<Step>("step", "Zero, then the level from control step `offset` to the end.",
                              "Glossop et al. 2022, fig. 2b (two steps into the episode); docs/disturbances.md 3.1");
}

}  // namespace gust
