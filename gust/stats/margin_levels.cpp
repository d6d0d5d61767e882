#include <algorithm>
#include <cmath>

#include "gust/core/error.h"
#include "gust/stats/margin.h"

namespace gust {
namespace {

constexpr double kWidestStep = 1.25;     // from one level to the next, below the crossings
constexpr double kStep = 1.24;           // of the scan: rounding may not widen a step beyond kWidestStep
constexpr double kFloor = 1e-2;          // of the lowest crossing: where the scan begins
constexpr std::size_t kMostBetween = 9;  // new levels in one gap at a time

/// To four significant digits: levels that people can read.
double readable(double level) { return std::stod(fmt::format("{:.4g}", level)); }

/// A sequence that first falls below 0 at levels[at].
struct Crossing {
  std::size_t at = 0;
  bool found = false;
};

Crossing crossing_of(const std::vector<double>& values) {
  const auto at = std::ranges::find_if(values, [](double v) { return v < 0; });
  return {static_cast<std::size_t>(at - values.begin()), at != values.end()};
}

/// The lower end of the interval: where the band crosses, or the step that holds a bound below it.
Crossing lower_end(const std::vector<double>& levels, const Crossing& band, double bound) {
  const auto at = static_cast<std::size_t>(std::ranges::lower_bound(levels, bound) - levels.begin());
  if (at == levels.size() || (band.found && band.at <= at)) return band;
  return {at, true};
}

/// Collects levels that are not there yet, strictly between two neighbours.
class NewLevels {
 public:
  explicit NewLevels(const std::vector<double>& known) : known_(known) {}

  void add(double low, double high, double level) {
    level = readable(level);
    if (level <= low || level >= high || std::ranges::binary_search(known_, level)) return;
    levels_.push_back(level);
  }

  std::vector<double> take() && {
    std::ranges::sort(levels_);
    levels_.erase(std::ranges::unique(levels_).begin(), levels_.end());
    return std::move(levels_);
  }

 private:
  const std::vector<double>& known_;
  std::vector<double> levels_;
};

/// Fills wide steps from the scan's floor up to `top`.
void scan(const std::vector<double>& levels, double floor, double top, NewLevels& out) {
  double before = floor;
  const auto first = std::ranges::find_if(levels, [](double level) { return level > 0; });
  if (first != levels.end() && *first > floor) out.add(0.0, *first, floor);
  for (auto at = first; at != levels.end() && before < top; ++at) {
    if (*at <= before) continue;
    const double end = *at;
    if (end > kWidestStep * before) {
      for (double level = before * kStep; level < end; level *= kStep) out.add(before, end, level);
    }
    before = end;
  }
}

/// Divides the step in which a sequence crosses, where it is wider than `width`.
void divide(const std::vector<double>& levels, const Crossing& crossing, double width, NewLevels& out) {
  if (!crossing.found || crossing.at == 0) return;
  const double low = levels[crossing.at - 1], high = levels[crossing.at];
  if (low == 0 || high - low <= width) return;  // below the smallest level it is the scan that goes on
  const auto parts = std::clamp(std::ceil((high - low) / width), 2.0, static_cast<double>(kMostBetween + 1));
  for (double part = 1; part < parts; ++part) out.add(low, high, low + (high - low) * part / parts);
}

/// The least that the margin can be when a sequence crosses there, 0 aside.
double smallest_margin(const std::vector<double>& levels, const Crossing& crossing) {
  if (!crossing.found) return levels.back();
  const double below = crossing.at > 0 ? levels[crossing.at - 1] : 0.0;
  return below > 0 ? below : levels[crossing.at];
}

/// Where the scan begins: below the lowest crossing of the three, as far as that can be told.
double scan_floor(const std::vector<double>& levels, const Crossing& lowest, double last) {
  if (!lowest.found) return kFloor * last;
  const double level = levels[lowest.at];
  return std::max(kFloor * level, kSmallestLevel * last);
}

}  // namespace

std::vector<double> next_margin_levels(const MarginCurve& curve, const MarginRule& rule, double tolerance) {
  GUST_CHECK(tolerance > 0);
  const std::vector<double>& levels = curve.levels;
  const MarginBands bands = margin_bands(curve, rule);
  const Crossing low = lower_end(levels, crossing_of(bands.low), falling_bound(curve, rule));
  const Crossing value = crossing_of(bands.value), high = crossing_of(bands.high);
  const double last = levels.back();
  NewLevels out(levels);
  const bool all_spent = high.found && levels[high.at] == 0;  // at level 0 already
  if (all_spent || !(last > 0)) return {};
  const bool open_below = low.found && levels[low.at] == 0;  // the interval reaches down to 0 whatever lies between
  const Crossing& lowest = !open_below ? low : value.found && levels[value.at] == 0 ? high : value;
  scan(levels, scan_floor(levels, lowest, last), high.found ? levels[high.at] : last, out);

  const double width = tolerance * smallest_margin(levels, value.found && levels[value.at] > 0 ? value : high);
  for (const Crossing* crossing : {&low, &value, &high}) divide(levels, *crossing, width, out);
  return std::move(out).take();
}

}  // namespace gust
