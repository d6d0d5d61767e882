#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct AnrH {
  static constexpr bool kHigherIsBetter = true;
  static constexpr std::string_view kUnit = "";
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return episode.ended.return_sum / static_cast<double>(episode.horizon); }
};

}  // namespace

Entry<Metric> metric_anr_h() {
  return metric_entry<AnrH>("anr_h", "Return divided by the full horizon: failing early costs what it should.",
                            "docs/metrics.md 1.1");
}

}  // namespace gust
