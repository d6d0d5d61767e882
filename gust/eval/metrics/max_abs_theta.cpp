#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct MaxAbsTheta {
  static constexpr MetricTraits kTraits = {.title = "max abs theta",
                                           .unit = "rad",
                                           .role = MetricRole::diagnostic,
                                           .higher_is_better = false,
                                           .needs = {.state = true}};
  static constexpr std::tuple<> kFields = {};

  static bool applies(const Interface& spec) { return has_state(spec, spec.angle, "theta"); }
  double value(const Episode& episode) const { return max_abs(episode.ended, episode.angle); }
};

}  // namespace

Entry<Metric> metric_max_abs_theta() {
  return metric_entry<MaxAbsTheta>("max_abs_theta", "Largest angle until the episode ends.", "gust");
}

}  // namespace gust
