#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct Length {
  static constexpr bool kHigherIsBetter = true;
  static constexpr std::string_view kUnit = "control steps";
  static constexpr std::tuple<> kFields = {};

  double value(const Episode& episode) const { return steps_of(episode.ended); }
};

}  // namespace

Entry<Metric> metric_length() {
  return metric_entry<Length>("length", "Control steps until the episode ends.", "gust");
}

}  // namespace gust
