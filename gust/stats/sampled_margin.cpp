#include "gust/stats/sampled_margin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "gust/core/error.h"

namespace gust {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The shares outside an interval, on one side, at which its ends are told, ascending to a half. One of them is 0.025.
std::vector<double> told_tails(std::size_t resamples) {
  constexpr double kStep = 1.2;
  std::vector<double> tails = {0.025};
  while (tails.front() * static_cast<double>(resamples) > 0.5) tails.insert(tails.begin(), tails.front() / kStep);
  while (tails.back() * kStep < 0.5) tails.push_back(tails.back() * kStep);
  return tails;
}

/// The nearest of them, as factors go.
std::size_t nearest(const std::vector<double>& tails, double tail) {
  const auto after = std::ranges::lower_bound(tails, tail);
  const auto place = static_cast<std::size_t>(after - tails.begin());
  if (place == 0) return 0;
  if (place == tails.size()) return place - 1;
  return tail * tail < tails[place - 1] * tails[place] ? place - 1 : place;
}

bool same_pair(const Sampled& a, const Sampled& b) {
  return a.margin && b.margin && a.margin->measured == b.margin->measured && a.margin->policy != b.margin->policy;
}

std::vector<Cell> cells_of(const MarginData& data) {
  std::vector<Cell> cells;
  for (const Matrix<double>& scores : data.scores) cells.push_back(scores.view());
  return cells;
}

template <class Ratio>
auto ratio_of(const MarginData& a, const MarginData& b, Ratio ratio) {
  const std::vector<Cell> cells_a = cells_of(a), cells_b = cells_of(b);
  return ratio(MarginCells{{a.levels, cells_a}, a.undisturbed.view()},
               MarginCells{{b.levels, cells_b}, b.undisturbed.view()}, MarginRule{}, a.rng);
}

}  // namespace

void MarginData::add(double level, Matrix<double> scores_there) {
  const auto at = std::ranges::lower_bound(levels, level) - levels.begin();
  if (at < std::ssize(levels) && levels[static_cast<std::size_t>(at)] == level) return;
  levels.insert(levels.begin() + at, level);
  scores.insert(scores.begin() + at, std::move(scores_there));
}

MarginCurve MarginData::curve() const {
  MarginCurve curve{.levels = levels, .scores = {}, .undisturbed = margin_scores(undisturbed.view())};
  curve.unit = unit_of(undisturbed.view());
  for (const Matrix<double>& at : scores) curve.scores.push_back(margin_scores(at.view()));
  return curve;
}

Sampled sampled_margin(Sampled drawn, std::shared_ptr<const MarginData> data) {
  const MarginCurve curve = data->curve();
  const std::string name = cat(data->policy, "/", data->measured);
  drawn.margin = std::move(data);
  if (drawn.values.size() < 3 || curve.undisturbed.size() < 2) return drawn;
  const std::size_t resamples = drawn.values.size() - 1;
  const std::vector<double> tails = told_tails(resamples);
  std::vector<Interval> ends;
  for (const double tail : tails) ends.push_back(margin(curve, {.confidence = 1.0 - 2.0 * tail}).level);
  if (std::isnan(drawn.estimate()) || std::isnan(ends.front().low)) return drawn;

  const Rng ties = Rng(0).split("margins").split(name);
  std::vector<std::size_t> order(resamples);
  std::iota(order.begin(), order.end(), std::size_t{1});
  std::ranges::sort(order, {}, [&](std::size_t k) {
    const Bounds range = drawn.bounds(k);
    return std::tuple(range.low, range.high, ties.bits(k), k);
  });
  Sampled told = drawn;
  for (std::size_t rank = 0; rank < resamples; ++rank) {
    const double tail = static_cast<double>(rank) / static_cast<double>(resamples - 1);
    const Interval& interval = ends[nearest(tails, std::min(tail, 1.0 - tail))];
    const double last = curve.levels.back();
    if (tail < 0.5)
      told.set(order[rank], interval.low < last ? Bounds(interval.low) : Bounds(last, kInfinity));
    else
      told.set(order[rank], std::isinf(interval.high) ? Bounds(last, kInfinity) : Bounds(interval.high));
  }
  if (!told.upper.empty() && told.limit.empty()) told.limit = cat("the levels end at ", curve.levels.back());
  return told;
}

Interval margin_ratio(const MarginData& a, const MarginData& b) {
  using Of = Interval (*)(const MarginCells&, const MarginCells&, const MarginRule&, const Rng&);
  return ratio_of(a, b, static_cast<Of>(margin_ratio));
}

std::optional<Sampled> sampled_ratio(const Sampled& a, const Sampled& b) {
  if (!same_pair(a, b)) return std::nullopt;
  Sampled ratio = ratio_of(*a.margin, *b.margin, sampled_margin_ratio);
  if (ratio.is_constant()) return std::nullopt;
  ratio.limit = a.limit.empty() ? b.limit : a.limit;
  return ratio;
}

std::optional<Sampled> sampled_difference(const Sampled& a, const Sampled& b) {
  if (!a.bounds(0).exact() || !b.bounds(0).exact() || !(a.estimate() > 0) || !(b.estimate() > 0)) return std::nullopt;
  std::optional<Sampled> ratio = sampled_ratio(a, b);
  if (!ratio) return std::nullopt;
  const double apart = std::log(a.estimate() / b.estimate());
  const double middle = apart == 0.0 ? a.estimate() : (a.estimate() - b.estimate()) / apart;
  Sampled difference = combine(*ratio, [middle](const Bounds& drawn) {
    return Bounds(middle * std::log(drawn.low), middle * std::log(drawn.high));
  });
  difference.set(0, a.estimate() - b.estimate());
  return difference;
}

}  // namespace gust
