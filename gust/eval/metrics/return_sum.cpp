#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct ReturnSum {
  static constexpr MetricTraits kTraits = {
      .title = "return sum", .role = MetricRole::score, .higher_is_better = true, .sums_over_row = true};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.ended.return_sum; }
};

}  // namespace

Entry<Metric> metric_return_sum() {
  return metric_entry<ReturnSum>("return_sum", "Sum of the rewards until the episode ends.",
                                 "Glossop et al. 2022, eq. 2");
}

}  // namespace gust
