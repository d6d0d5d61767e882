#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct AnrNt {
  static constexpr bool kHigherIsBetter = true;
  static constexpr std::string_view kUnit = "";
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.whole.return_sum / static_cast<double>(episode.horizon); }
};

}  // namespace

Entry<Metric> metric_anr_nt() {
  return metric_entry<AnrNt>("anr_nt", "Return over the full horizon, divided by it, when failure ends nothing.",
                             "docs/metrics.md 1.1");
}

}  // namespace gust
