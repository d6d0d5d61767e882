#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct Saturation {
  static constexpr MetricTraits kTraits = {.title = "saturation",
                                           .role = MetricRole::saturation,
                                           .higher_is_better = false,
                                           .needs = {.effort = true},
                                           .low = 0,
                                           .high = 1};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const {
    return static_cast<double>(episode.ended.saturated_steps) / steps_of(episode.ended);
  }
};

}  // namespace

Entry<Metric> metric_saturation() {
  return metric_entry<Saturation>("saturation", "Share of the control steps in which the actuator saturated.", "gust");
}

}  // namespace gust
