#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct TimeToFailure {
  static constexpr MetricTraits kTraits = {.title = "time to failure",
                                           .unit = "s",
                                           .role = MetricRole::failure_time,
                                           .higher_is_better = true,
                                           .needs = {.failure = true}};
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return static_cast<double>(episode.safe_steps) / episode.control_rate; }
};

}  // namespace

Entry<Metric> metric_time_to_failure() {
  return metric_entry<TimeToFailure>("time_to_failure",
                                     "Time until the state leaves the safe set; the horizon if it never does.", "gust");
}

}  // namespace gust
