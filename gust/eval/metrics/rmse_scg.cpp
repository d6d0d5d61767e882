#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct RmseScg {
  static constexpr MetricTraits kTraits = {.title = "rmse scg",
                                           .unit = "mixed",
                                           .role = MetricRole::error,
                                           .higher_is_better = false,
                                           .needs = {.goal = true},
                                           .sums_over_row = true};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return rmse_masked(episode.ended); }
};

}  // namespace

Entry<Metric> metric_rmse_scg() {
  return metric_entry<RmseScg>("rmse_scg", "Root mean squared error of the weighted positions until the episode ends.",
                               "safe-control-gym; docs/metrics.md 1.2");
}

}  // namespace gust
