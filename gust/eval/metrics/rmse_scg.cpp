#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct RmseScg {
  static constexpr bool kHigherIsBetter = false;
  static constexpr std::string_view kUnit = "mixed";
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return rmse_masked(episode.ended); }
};

}  // namespace

Entry<Metric> metric_rmse_scg() {
  return metric_entry<RmseScg>("rmse_scg", "Root mean squared error of the weighted positions until the episode ends.",
                               "safe-control-gym; docs/metrics.md 1.2");
}

}  // namespace gust
