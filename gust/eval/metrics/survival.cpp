#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct Survival {
  static constexpr MetricTraits kTraits = {.title = "survival",
                                           .role = MetricRole::survival,
                                           .higher_is_better = true,
                                           .zero_or_one = true,
                                           .needs = {.failure = true},
                                           .low = 0,
                                           .high = 1,
                                           .lead = 3};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.failed ? 0.0 : 1.0; }
};

}  // namespace

Entry<Metric> metric_survival() {
  return metric_entry<Survival>(
      "survival", "1 if the state never left the safe set, else 0; its mean is the share that survives.", "gust");
}

}  // namespace gust
