#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct MaxAbsX {
  static constexpr MetricTraits kTraits = {.title = "max abs x",
                                           .unit = "m",
                                           .role = MetricRole::diagnostic,
                                           .higher_is_better = false,
                                           .needs = {.state = true}};
  static constexpr std::tuple<> kFields = {};

  static bool applies(const Interface& spec) { return has_state(spec, 0, "x"); }
  double value(const Episode& episode) const { return max_abs(episode.ended, 0); }
};

}  // namespace

Entry<Metric> metric_max_abs_x() {
  return metric_entry<MaxAbsX>("max_abs_x", "Largest distance from the origin until the episode ends.", "gust");
}

}  // namespace gust
