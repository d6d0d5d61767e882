#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct RmseSum {
  static constexpr bool kHigherIsBetter = false;
  static constexpr std::string_view kUnit = "mixed";
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return root_sum(episode.ended); }
};

}  // namespace

Entry<Metric> metric_rmse_sum() {
  return metric_entry<RmseSum>("rmse_sum",
                               "Root of the summed squared state error, all components, until the episode ends.",
                               "docs/metrics.md 1.2");
}

}  // namespace gust
