#include "gust/stats/formula_functions.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "gust/stats/margin.h"
#include "gust/stats/rank_correlation.h"
#include "gust/stats/sampled_margin.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

using Arguments = std::vector<FormulaValue>;
using Values = std::span<const double>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The numbers of one list, or the arguments themselves where they are numbers.
std::vector<Sampled> numbers_of(const Arguments& arguments, std::string_view what) {
  std::vector<Sampled> numbers;
  if (arguments.size() == 1) {
    numbers = arguments[0].as_numbers(what);
  } else {
    for (const FormulaValue& argument : arguments) numbers.push_back(argument.as_number(what));
  }
  if (numbers.empty()) throw NotTestable(cat("'", what, "' of nothing"));
  return numbers;
}

std::vector<Truth> truths_of(const FormulaValue& list, std::string_view what) {
  std::vector<Truth> truths;
  for (const FormulaValue& item : list.as_list(what).items) truths.push_back(item.as_truth(what));
  if (truths.empty()) throw NotTestable(cat("'", what, "' of nothing"));
  return truths;
}

std::vector<Sampled> margins_of(const FormulaValue& list, std::string_view what) {
  std::vector<Sampled> margins;
  for (Truth& truth : truths_of(list, what)) margins.push_back(std::move(truth.margin));
  return margins;
}

double smallest(Values values) { return *std::ranges::min_element(values); }
double largest(Values values) { return *std::ranges::max_element(values); }
double total(Values values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}
double holding(Values margins) {
  return static_cast<double>(std::ranges::count_if(margins, [](double margin) { return margin >= 0; }));
}

/// Of functions that do not fall when one of the numbers grows.
template <double (*kOf)(Values)>
FormulaValue of_numbers(const Arguments& arguments) {
  const std::vector<Sampled> numbers = numbers_of(arguments, "a function of numbers");
  Sampled result = combine_rising(numbers, kOf);
  return {kOf == total ? std::move(result) : between(numbers, std::move(result))};
}
FormulaValue all(const Arguments& arguments) {
  Truth whole(combine_rising(margins_of(arguments[0], "all"), smallest));
  for (const Truth& truth : truths_of(arguments[0], "all"))
    std::ranges::move(truth.all_parts(), std::back_inserter(whole.parts));
  return {std::move(whole)};
}
FormulaValue any(const Arguments& arguments) {
  const std::vector<Truth> truths = truths_of(arguments[0], "any");
  Truth one(combine_rising(margins_of(arguments[0], "any"), largest));
  const auto same = [&](const Truth& truth) { return truth.share_bound == truths.front().share_bound; };
  if (std::ranges::all_of(truths, same)) one.share_bound = truths.front().share_bound;
  return {std::move(one)};
}
FormulaValue count(const Arguments& arguments) { return {combine_rising(margins_of(arguments[0], "count"), holding)}; }
FormulaValue share(const Arguments& arguments) {
  return {combine_rising(margins_of(arguments[0], "share"),
                         [](Values margins) { return holding(margins) / static_cast<double>(margins.size()); })};
}
FormulaValue absolute(const Arguments& arguments) {
  return {combine(arguments[0].as_number("abs"), [](const Bounds& value) { return abs(value); })};
}

/// A list with an axis.
struct CurveArgument {
  const std::vector<double>& axis;
  std::vector<Sampled> values;
};
CurveArgument curve_of(const FormulaValue& value, std::string_view what) {
  const FormulaList& list = value.as_list(what);
  if (list.axis.empty()) throw Error(cat("'", what, "' needs a curve: scores along levels, or along another number"));
  return {list.axis, value.as_numbers(what)};
}

FormulaValue levels(const Arguments& arguments) {
  FormulaList list;
  list.axis = curve_of(arguments[0], "levels").axis;
  for (const double at : list.axis) list.items.emplace_back().data = Sampled::constant(at);
  return {std::move(list)};
}

/// The value at a place, straight between two points.
FormulaValue at(const Arguments& arguments) {
  const CurveArgument curve = curve_of(arguments[0], "at");
  const Sampled& where = arguments[1].as_number("at");
  if (!where.is_constant()) throw Error("'at' needs a fixed place");
  const double x = where.estimate();
  if (std::isnan(x)) throw NotTestable("'at' a place that is NaN");
  const auto after = std::ranges::lower_bound(curve.axis, x);
  if (after == curve.axis.end() || x < curve.axis.front())
    throw BeyondLevels(cat(x, " lies beyond the levels, ", curve.axis.front(), " to ", curve.axis.back()));
  const auto right = static_cast<std::size_t>(after - curve.axis.begin());
  if (*after == x) return {curve.values[right]};
  const double share = (x - curve.axis[right - 1]) / (curve.axis[right] - curve.axis[right - 1]);
  const auto around = std::span(curve.values).subspan(right - 1, 2);
  return {between(
      around, combine_rising(around, [share](Values values) { return values[0] + share * (values[1] - values[0]); }))};
}

CurveArgument filled_curve_of(const FormulaValue& value, std::string_view what) {
  CurveArgument curve = curve_of(value, what);
  if (curve.values.empty()) throw NotTestable(cat("'", what, "' of nothing"));
  return curve;
}

/// A number that is made of a curve's axis and its values in each resample.
template <class Function>
FormulaValue of_curve(const FormulaValue& value, std::string_view what, Function function) {
  const CurveArgument curve = filled_curve_of(value, what);
  return {combine(curve.values, [&](Values values) { return function(Values(curve.axis), values); })};
}
/// A place on the axis of a curve, found by function(axis, values, reference), which may be a bound: infinite above
/// where it lies beyond the last one, or further where `beyond` says so.
template <class Function>
FormulaValue place_on(const CurveArgument& curve, const Sampled& reference, bool beyond, Function function) {
  const double last = curve.axis.back();
  std::vector<Sampled> numbers = curve.values;
  numbers.push_back(reference);
  bool ends = false;
  Sampled found = combine(numbers, [&](Values values) -> Bounds {
    const Bounds place = function(Values(curve.axis), values.first(curve.axis.size()), values.back());
    ends = ends || std::isinf(place.high);
    return beyond && std::isinf(place.high) ? Bounds(std::nextafter(last, kInfinity), kInfinity) : place;
  });
  if (!found.upper.empty() && found.limit.empty())
    found.limit = ends ? cat("the levels end at ", last) : cat("the levels begin at ", curve.axis.front());
  return {std::move(found)};
}

template <bool kLast>
FormulaValue end_of(const Arguments& arguments) {
  const FormulaList& list = arguments[0].as_list("first or last");
  if (list.items.empty()) throw NotTestable("the end of nothing");
  return kLast ? list.items.back() : list.items.front();
}

/// Two numbers that the data cannot tell apart are alike, by more than any number says, and so are two that differ by
/// no more than the tolerance. A number that is known as a bound only overlaps with what lies beyond it or not: that is
/// not known.
FormulaValue alike(const Arguments& arguments) {
  const Sampled& a = arguments[0].as_number("alike");
  const Sampled& b = arguments[1].as_number("alike");
  const Interval of_a = interval_of(a), of_b = interval_of(b);
  if (of_a.low <= of_b.high && of_b.low <= of_a.high) {
    Truth overlap(Sampled::constant(kInfinity));
    const bool known = a.bounds(0).exact() && b.bounds(0).exact();
    if (!known) overlap.margin.set(0, {-kInfinity, kInfinity});
    if (!known) overlap.margin.limit = a.bounds(0).exact() ? b.limit : a.limit;
    return {Truth(std::move(overlap.margin))};
  }
  const Sampled apart = combine(a, b, [](const Bounds& x, const Bounds& y) { return abs(x - y); });
  return {Truth(combine(arguments[2].as_number("alike"), apart, std::minus<>()))};
}

FormulaValue area(const Arguments& arguments) {
  const CurveArgument curve = filled_curve_of(arguments[0], "area");
  const std::vector<double>& x = curve.axis;
  return {between(curve.values, combine_rising(curve.values, [&x](Values y) {
                    if (x.size() == 1) return y[0];
                    double sum = 0;
                    for (std::size_t i = 1; i < x.size(); ++i) sum += 0.5 * (x[i] - x[i - 1]) * (y[i] + y[i - 1]);
                    return sum / (x.back() - x.front());
                  }))};
}
/// Refuses a curve along levels that has no margin.
void check_has_margin(const FormulaList& list) {
  if (!list.no_margin.empty()) throw BeyondLevels(cat("there is no margin: ", list.no_margin));
}
/// Where a curve falls below a fraction of the undisturbed score.
FormulaValue fall_of(const FormulaList& list, const CurveArgument& curve, const MarginRule& rule) {
  const Sampled& undisturbed = list.undisturbed ? *list.undisturbed : curve.values.front();
  return place_on(curve, undisturbed, !rule.interpolated,
                  [&](Values x, Values y, double reference) { return crossing(x, y, reference, rule); });
}
FormulaValue half(const Arguments& arguments) {
  const FormulaList& list = arguments[0].as_list("half");
  if (!list.axis.empty() && list.axis.front() < 0) check_has_margin(list);
  return fall_of(list, filled_curve_of(arguments[0], "half"), kHalfScore);
}
/// A curve with the values at levels that its margin asked for, in their places.
FormulaList with_added(const FormulaList& list) {
  FormulaList all{list.items, list.axis, {}, {}};
  for (std::size_t i = 0; i < list.added_axis.size(); ++i) {
    const auto at = std::ranges::lower_bound(all.axis, list.added_axis[i]) - all.axis.begin();
    if (all.axis[static_cast<std::size_t>(at)] == list.added_axis[i]) continue;  // added levels lie below the last
    all.items.insert(all.items.begin() + at, list.added[i]);
    all.axis.insert(all.axis.begin() + at, list.added_axis[i]);
  }
  return all;
}
FormulaValue margin_of(const Arguments& arguments) {
  const FormulaList& list = arguments[0].as_list("margin");
  check_has_margin(list);
  const FormulaValue all{with_added(list)};
  const FormulaValue found = fall_of(list, filled_curve_of(all, "margin"), MarginRule{});
  const Sampled& drawn = found.as_number("margin");
  std::shared_ptr<const MarginData> data = list.margin_data ? list.margin_data() : nullptr;
  return {data == nullptr ? drawn : sampled_margin(drawn, std::move(data))};
}
FormulaValue reach(const Arguments& arguments) {
  const CurveArgument curve = filled_curve_of(arguments[0], "reach");
  return place_on(curve, arguments[1].as_number("reach"), true, [](Values x, Values y, double value) -> Bounds {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (y[i] >= value) return x[i];
    }
    return {x.back(), kInfinity};
  });
}
FormulaValue drop(const Arguments& arguments) {
  return of_curve(arguments[0], "drop", [](Values, Values y) {
    double most = 0;
    for (std::size_t i = 1; i < y.size(); ++i) most = std::max(most, y[i - 1] - y[i]);
    return most;
  });
}
FormulaValue rise(const Arguments& arguments) {
  return of_curve(arguments[0], "rise", [](Values, Values y) {
    double sum = 0;
    for (std::size_t i = 1; i < y.size(); ++i) sum += std::max(y[i] - y[i - 1], 0.0);
    return sum / static_cast<double>(std::max<std::size_t>(y.size() - 1, 1));
  });
}
FormulaValue argmax(const Arguments& arguments) {
  const CurveArgument curve = filled_curve_of(arguments[0], "argmax");
  const auto largest_at = [&](Values y) {
    return curve.axis[static_cast<std::size_t>(std::ranges::max_element(y) - y.begin())];
  };
  return {combine(curve.values, largest_at, [&](std::span<const Bounds> ranges) -> Bounds {
    const auto most = std::ranges::max_element(ranges, {}, &Bounds::low);
    const bool clear =
        std::ranges::all_of(ranges, [&](const Bounds& other) { return &other == &*most || other.high < most->low; });
    if (clear) return curve.axis[static_cast<std::size_t>(most - ranges.begin())];
    return {curve.axis.front(), curve.axis.back()};
  })};
}
FormulaValue straightness(const Arguments& arguments) {
  return of_curve(arguments[0], "straightness", [](Values x, Values y) {
    const double r = pearson(x, y);
    return r * r;
  });
}

/// The lower ends of ranges that lie one above the other, which have their ranks; none where two overlap.
std::optional<std::vector<double>> with_ranks(std::span<const Bounds> ranges) {
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const Bounds &a = ranges[i], &b = ranges[k];
      if (!(a.exact() && b.exact()) && a.low <= b.high && b.low <= a.high) return std::nullopt;
    }
  }
  std::vector<double> ends;
  for (const Bounds& range : ranges) ends.push_back(range.low);
  return ends;
}

/// A rank correlation of two lists, or of a curve with its axis. Of bounds it is known where their ranks are.
template <double (*kOf)(Values, Values)>
FormulaValue correlation(const Arguments& arguments) {
  constexpr std::string_view kWhat = "a rank correlation";
  std::vector<Sampled> numbers, others;
  if (arguments.size() == 1) {
    const CurveArgument curve = filled_curve_of(arguments[0], kWhat);
    for (const double at : curve.axis) numbers.push_back(Sampled::constant(at));
    others = curve.values;
  } else {
    numbers = arguments[0].as_numbers(kWhat);
    others = arguments[1].as_numbers(kWhat);
  }
  if (numbers.size() != others.size())
    throw Error(cat(kWhat, " needs lists of one length, got ", numbers.size(), " and ", others.size()));
  numbers.insert(numbers.end(), others.begin(), others.end());
  const std::size_t size = others.size();
  const auto of_values = [size](Values both) { return kOf(both.first(size), both.last(size)); };
  return {combine(numbers, of_values, [&](std::span<const Bounds> both) -> Bounds {
    const auto first = with_ranks(both.first(size)), last = with_ranks(both.last(size));
    return first && last ? Bounds(kOf(*first, *last)) : Bounds(-1.0, 1.0);
  })};
}

constexpr FormulaFunction kFunctions[] = {
    {"mean", "list", "of a list of numbers, or of several numbers", 1, 99, of_numbers<mean>},
    {"median", "list", "of the same", 1, 99, of_numbers<median>},
    {"min", "list", "the least", 1, 99, of_numbers<smallest>},
    {"max", "list", "the greatest", 1, 99, of_numbers<largest>},
    {"sum", "list", "of the same", 1, 99, of_numbers<total>},
    {"abs", "number", "without its sign", 1, 1, absolute},
    {"all", "list", "whether every statement of a list holds", 1, 1, all},
    {"any", "list", "whether one of them does", 1, 1, any},
    {"count", "list", "how many of them hold", 1, 1, count},
    {"share", "list", "which share of them holds, 0 to 1", 1, 1, share},
    {"alike", "number, number, tolerance",
     "whether two 95 % intervals overlap, or the numbers differ by no more than the tolerance", 3, 3, alike},
    {"first", "list", "its first item", 1, 1, end_of<false>},
    {"last", "list", "its last item", 1, 1, end_of<true>},
    {"levels", "curve", "where its values stand: levels, or steps", 1, 1, levels},
    {"at", "curve, place", "its value there, straight between two points", 2, 2, at},
    {"area", "curve", "the area under it over its width: the mean value", 1, 1, area},
    {"half", "curve",
     "the first level with less than half of the undisturbed score (of its first value, if it has none); beyond the "
     "last "
     "if there is none",
     1, 1, half},
    {"margin", "curve",
     "the level at which it falls below 90 % of the undisturbed score (of its first value, if it has none), between "
     "levels; at least the last if it never does",
     1, 1, margin_of},
    {"reach", "curve, bound", "the first place at which it is at least the bound; beyond the last if there is none", 2,
     2, reach},
    {"drop", "curve", "the greatest fall from one point to the next", 1, 1, drop},
    {"rise", "curve", "the mean rise from one point to the next, a fall counting as none", 1, 1, rise},
    {"argmax", "curve", "where it is greatest, the first place of several", 1, 1, argmax},
    {"straightness", "curve", "R^2 of a straight line through it", 1, 1, straightness},
    {"spearman", "list, list", "rank correlation of two lists, or of one curve with its axis", 1, 2,
     correlation<spearman>},
    {"kendall", "list, list", "Kendall's tau-b of the same", 1, 2, correlation<kendall>},
};

}  // namespace

std::span<const FormulaFunction> formula_functions() { return kFunctions; }

}  // namespace gust
