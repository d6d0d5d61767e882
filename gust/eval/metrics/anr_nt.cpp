#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct AnrNt {
  static constexpr MetricTraits kTraits = {.title = "return / horizon, not terminated",
                                           .role = MetricRole::score,
                                           .higher_is_better = true,
                                           .needs = {.after_failure = true},
                                           .mean_reward = true};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.whole.return_sum / static_cast<double>(episode.horizon); }
};

}  // namespace

Entry<Metric> metric_anr_nt() {
  return metric_entry<AnrNt>("anr_nt", "Return over the full horizon, divided by it, when failure ends nothing.",
                             "docs/metrics.md 1.1");
}

}  // namespace gust
