#include "gust/stats/interval.h"

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

namespace {

/// "0.953", "≥ 0.02", "≤ 0.02", "0.01 to 0.02"
std::string estimate_text(const Interval& interval) {
  if (std::isnan(interval.most)) return format("{:.4g}", interval.estimate);
  if (std::isinf(interval.estimate) && std::isinf(interval.most)) return "unknown";
  if (std::isinf(interval.most)) return format("≥ {:.4g}", interval.estimate);
  if (std::isinf(interval.estimate) || interval.estimate == 0.0) return format("≤ {:.4g}", interval.most);
  return format("{:.4g} to {:.4g}", interval.estimate, interval.most);
}

/// "[0.91, 0.987]", "[≥ 0.02]" where there is no upper end.
std::string ends_text(double low, double high) {
  if (std::isinf(high) && std::isfinite(low)) return format("[≥ {:.4g}]", low);
  if (std::isinf(low) && std::isfinite(high)) return format("[≤ {:.4g}]", high);
  return format("[{:.4g}, {:.4g}]", low, high);
}

}  // namespace

std::string interval_text(const Interval& interval) {
  const std::string estimate = estimate_text(interval);
  if (std::isnan(interval.low) || std::isnan(interval.high)) return estimate + " (no interval)";
  const std::string ends = cat(estimate, " ", ends_text(interval.low, interval.high));
  return interval.unit == Unit::none ? ends : format("{} ({} {})", ends, interval.n, unit_name(interval.unit));
}

}  // namespace gust
