#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct AnrH {
  static constexpr MetricTraits kTraits = {
      .title = "return / horizon", .role = MetricRole::score, .higher_is_better = true, .mean_reward = true, .lead = 1};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.ended.return_sum / static_cast<double>(episode.horizon); }
};

}  // namespace

Entry<Metric> metric_anr_h() {
  return metric_entry<AnrH>("anr_h", "Return divided by the full horizon: failing early costs what it should.",
                            "docs/metrics.md 1.1");
}

}  // namespace gust
