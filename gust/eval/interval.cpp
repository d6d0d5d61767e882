#include "gust/eval/interval.h"

#include <cmath>

#include "gust/core/error.h"

namespace gust {

std::string_view unit_name(Unit unit) {
  switch (unit) {
    case Unit::seeds:
      return "seeds";
    case Unit::episodes:
      return "episodes";
    case Unit::none:
      break;
  }
  return "none";
}

std::string interval_text(const Interval& interval) {
  const std::string estimate = format("{:.4g}", interval.estimate);
  if (std::isnan(interval.low) || std::isnan(interval.high)) return estimate + " (no interval)";
  const std::string ends = format("{} [{:.4g}, {:.4g}]", estimate, interval.low, interval.high);
  return interval.unit == Unit::none ? ends : fmt::format("{} ({} {})", ends, interval.n, unit_name(interval.unit));
}

}  // namespace gust
