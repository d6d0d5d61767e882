#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct ReturnSum {
  static constexpr bool kHigherIsBetter = true;
  static constexpr std::string_view kUnit = "";
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.ended.return_sum; }
};

}  // namespace

Entry<Metric> metric_return_sum() {
  return metric_entry<ReturnSum>("return_sum", "Sum of the rewards until the episode ends.",
                                 "Glossop et al. 2022, eq. 2");
}

}  // namespace gust
