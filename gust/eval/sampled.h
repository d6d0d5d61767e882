#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "gust/eval/interval.h"

namespace gust {

/// A number and what it becomes in each resample of the data. Arithmetic goes resample by resample, so whatever is
/// computed from such numbers has an interval.
struct Sampled {
  std::vector<double> values;  ///< the estimate, then one value a resample; one value alone is the same in all

  static Sampled constant(double value) { return {{value}}; }

  double estimate() const { return values.front(); }
  bool is_constant() const { return values.size() == 1; }
  double at(std::size_t i) const { return values[is_constant() ? 0 : i]; }
};

/// function(values) in every resample, of numbers that have equally many or are constant; not a number where one of
/// them is none.
template <class Function>
Sampled combine(std::span<const Sampled> numbers, Function&& function) {
  Sampled result{std::vector<double>(1)};
  for (const Sampled& number : numbers) {
    if (number.values.size() > result.values.size()) result.values.resize(number.values.size());
  }
  std::vector<double> together(numbers.size());
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    std::ranges::transform(numbers, together.begin(), [i](const Sampled& number) { return number.at(i); });
    const auto unknown = std::ranges::find_if(together, [](double value) { return std::isnan(value); });
    result.values[i] = unknown == together.end() ? function(std::span<const double>(together)) : *unknown;
  }
  return result;
}

/// function(a, b) in every resample.
template <class Function>
Sampled combine(const Sampled& a, const Sampled& b, Function&& function) {
  Sampled result{std::vector<double>(std::max(a.values.size(), b.values.size()))};
  for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] = function(a.at(i), b.at(i));
  return result;
}

/// function(a) in every resample.
template <class Function>
Sampled combine(const Sampled& a, Function&& function) {
  Sampled result{a.values};
  std::ranges::transform(a.values, result.values.begin(), function);
  return result;
}

/// The estimate between the percentiles of its resamples. A constant is its own interval; where a resample is not a
/// number there is none.
Interval interval_of(const Sampled& number, double confidence = 0.95);

}  // namespace gust
