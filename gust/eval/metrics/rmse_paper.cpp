#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct RmsePaper {
  static constexpr MetricTraits kTraits = {.title = "rmse paper",
                                           .unit = "mixed",
                                           .role = MetricRole::error,
                                           .higher_is_better = false,
                                           .needs = {.goal = true, .after_failure = true},
                                           .sums_over_row = true,
                                           .lead = 4};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return rmse_all(episode.whole); }
};

}  // namespace

Entry<Metric> metric_rmse_paper() {
  return metric_entry<RmsePaper>(
      "rmse_paper", "Root mean squared state error, all components, over the whole horizon without termination.",
      "docs/metrics.md 1.2");
}

}  // namespace gust
