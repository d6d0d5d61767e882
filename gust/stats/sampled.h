#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gust/stats/interval.h"

namespace gust {

/// What is known of a number: that it lies between two ends. Most numbers are exact; a margin beyond the levels is at
/// least the last one, and its range ends at infinity.
struct Bounds {
  double low;
  double high;

  Bounds(double exact) : low(exact), high(exact) {}  // NOLINT: a number is a range
  Bounds(double from, double to) : low(from), high(to) {}
  static Bounds unknown() {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  bool exact() const { return !(low < high); }
};

Bounds operator-(const Bounds& range);
Bounds operator+(const Bounds& a, const Bounds& b);
Bounds operator-(const Bounds& a, const Bounds& b);
Bounds operator*(const Bounds& a, const Bounds& b);
/// Not a number where b is 0, unknown where b may be 0.
Bounds operator/(const Bounds& a, const Bounds& b);
Bounds abs(const Bounds& range);

struct MarginData;

/// A number and its value in each resample of the data. Arithmetic goes resample by resample, so whatever is
/// computed from such numbers has an interval. Where a resample is known as a bound only, arithmetic keeps both ends.
struct Sampled {
  std::vector<double> values;      ///< the estimate, then one value a resample; one value alone is the same in all
  std::vector<double> upper = {};  ///< where values are lower bounds the upper ones; empty if all are exact
  std::string limit = {};          ///< why there are bounds: "the levels end at 0.02"
  Unit unit = Unit::none;          ///< what was resampled; none of a constant
  std::size_t n = 0;               ///< how many there were, of several numbers the fewest
  bool mixed = false;              ///< computed from numbers with different units
  bool is_share = false;  ///< a share of successes, or one between several: its ends are those of Wilson's interval
  bool at_ends = false;   ///< computed from shares that are all 0 or 1: its spread falls with 1 / n, not 1 / sqrt(n)
  /// Of a margin what it was measured from, else null; many copies share it, for it holds the scores of whole curves.
  std::shared_ptr<const MarginData> margin = {};

  static Sampled constant(double value) { return {{value}}; }

  double estimate() const { return values.front(); }
  bool is_constant() const { return values.size() == 1; }
  double at(std::size_t i) const { return values[is_constant() ? 0 : i]; }
  Bounds bounds(std::size_t i) const {
    const std::size_t place = is_constant() ? 0 : i;
    return upper.empty() ? Bounds(values[place]) : Bounds(values[place], upper[place]);
  }
  /// The upper ends, which are the values where all are exact.
  const std::vector<double>& upper_ends() const { return upper.empty() ? values : upper; }

  void set(std::size_t i, const Bounds& range);
  /// Takes over from a number that this one is computed from: its unit and why it is a bound.
  void inherit(const Sampled& from);
};

/// exact(values) in every resample, of numbers that have equally many or are constant; bounded(ranges) where one of
/// them is a bound. Both give a number or a Bounds. Not a number where one of them is none.
template <class Exact, class Bounded>
Sampled combine(std::span<const Sampled> numbers, Exact&& exact, Bounded&& bounded) {
  Sampled result{std::vector<double>(1)};
  bool any_bound = false;
  for (const Sampled& number : numbers) {
    if (number.values.size() > result.values.size()) result.values.resize(number.values.size());
    result.inherit(number);
    any_bound = any_bound || !number.upper.empty();
  }
  std::vector<double> together(numbers.size());
  std::vector<Bounds> ranges;
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    std::ranges::transform(numbers, together.begin(), [i](const Sampled& number) { return number.at(i); });
    const auto unknown = std::ranges::find_if(together, [](double value) { return std::isnan(value); });
    ranges.clear();
    for (std::size_t k = 0; any_bound && k < numbers.size(); ++k) ranges.push_back(numbers[k].bounds(i));
    if (unknown != together.end())
      result.set(i, *unknown);
    else if (std::ranges::all_of(ranges, &Bounds::exact))
      result.set(i, exact(std::span<const double>(together)));
    else
      result.set(i, bounded(std::span<const Bounds>(ranges)));
  }
  return result;
}

/// The same of a function that a bound leaves unknown.
template <class Function>
Sampled combine(std::span<const Sampled> numbers, Function&& function) {
  return combine(numbers, function, [](std::span<const Bounds>) { return Bounds::unknown(); });
}

/// The same of a function that does not fall when one of the numbers grows.
template <class Function>
Sampled combine_rising(std::span<const Sampled> numbers, Function&& function) {
  return combine(numbers, function, [&](std::span<const Bounds> ranges) {
    std::vector<double> ends(ranges.size());
    std::ranges::transform(ranges, ends.begin(), &Bounds::low);
    const double low = function(std::span<const double>(ends));
    std::ranges::transform(ranges, ends.begin(), &Bounds::high);
    return Bounds(low, function(std::span<const double>(ends)));
  });
}

/// function(a, b) of the ranges in every resample.
template <class Function>
Sampled combine(const Sampled& a, const Sampled& b, Function&& function) {
  Sampled result{std::vector<double>(std::max(a.values.size(), b.values.size()))};
  result.inherit(a);
  result.inherit(b);
  for (std::size_t i = 0; i < result.values.size(); ++i) result.set(i, function(a.bounds(i), b.bounds(i)));
  return result;
}

/// function(a) of the range in every resample.
template <class Function>
Sampled combine(const Sampled& a, Function&& function) {
  Sampled result{std::vector<double>(a.values.size())};
  result.inherit(a);
  for (std::size_t i = 0; i < result.values.size(); ++i) result.set(i, function(a.bounds(i)));
  return result;
}

/// A number between others, such as their minimum or mean, is a share of successes where all of them are.
Sampled between(std::span<const Sampled> numbers, Sampled result);

/// The estimate between the percentiles of its resamples: of the lower ends below, of the upper ends above. A constant
/// is its own interval; where a resample is not a number there is none.
Interval interval_of(const Sampled& number, double confidence = 0.95);

}  // namespace gust
