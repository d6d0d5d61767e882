#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct AnrPooled {
  static constexpr MetricTraits kTraits = {
      .title = "mean return / mean length", .role = MetricRole::score, .higher_is_better = true, .mean_reward = true};
  static constexpr Quotient kQuotient = {"return_sum", "length"};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.ended.return_sum / steps_of(episode.ended); }
};

}  // namespace

Entry<Metric> metric_anr_pooled() {
  return metric_entry<AnrPooled>("anr_pooled",
                                 "Mean return over the episodes of a cell, divided by their mean length: long episodes "
                                 "count for more than in anr.",
                                 "what the scripts of Glossop et al. 2022 store (mean return and mean length)");
}

}  // namespace gust
