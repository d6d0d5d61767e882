#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct SquaredStateSum {
  static constexpr MetricTraits kTraits = {.title = "squared state sum",
                                           .unit = "mixed",
                                           .role = MetricRole::error,
                                           .higher_is_better = false,
                                           .needs = {.state = true},
                                           .sums_over_row = true};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.ended.squared_state; }
};

}  // namespace

Entry<Metric> metric_squared_state_sum() {
  return metric_entry<SquaredStateSum>("squared_state_sum",
                                       "Sum of the squared state after each step, all components in SI units, until "
                                       "the episode ends: it grows with the length of the episode.",
                                       "the \"cost\" that the scripts of Glossop et al. 2022 plot");
}

}  // namespace gust
