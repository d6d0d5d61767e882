#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct Anr {
  static constexpr MetricTraits kTraits = {
      .title = "return / length", .role = MetricRole::score, .higher_is_better = true, .mean_reward = true, .lead = 2};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.ended.return_sum / steps_of(episode.ended); }
};

}  // namespace

Entry<Metric> metric_anr() {
  return metric_entry<Anr>(
      "anr", "Return divided by the length of the episode: the paper's metric, which forgives early failure.",
      "Glossop et al. 2022, eq. 3; docs/metrics.md 1.1");
}

}  // namespace gust
