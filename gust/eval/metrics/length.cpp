#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct Length {
  static constexpr MetricTraits kTraits = {.title = "length",
                                           .unit = "control steps",
                                           .role = MetricRole::length,
                                           .higher_is_better = true,
                                           .sums_over_row = true};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return steps_of(episode.ended); }
};

}  // namespace

Entry<Metric> metric_length() {
  return metric_entry<Length>("length", "Control steps until the episode ends.", "gust");
}

}  // namespace gust
