#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct RmseSum {
  static constexpr MetricTraits kTraits = {.title = "rmse sum",
                                           .unit = "mixed",
                                           .role = MetricRole::error,
                                           .higher_is_better = false,
                                           .needs = {.goal = true},
                                           .sums_over_row = true};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return root_sum(episode.ended); }
};

}  // namespace

Entry<Metric> metric_rmse_sum() {
  return metric_entry<RmseSum>("rmse_sum",
                               "Root of the summed squared state error, all components, until the episode ends.",
                               "docs/metrics.md 1.2");
}

}  // namespace gust
