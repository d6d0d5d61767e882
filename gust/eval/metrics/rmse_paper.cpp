#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct RmsePaper {
  static constexpr bool kHigherIsBetter = false;
  static constexpr std::string_view kUnit = "mixed";
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return rmse_all(episode.whole); }
};

}  // namespace

Entry<Metric> metric_rmse_paper() {
  return metric_entry<RmsePaper>(
      "rmse_paper", "Root mean squared state error, all components, over the whole horizon without termination.",
      "docs/metrics.md 1.2");
}

}  // namespace gust
