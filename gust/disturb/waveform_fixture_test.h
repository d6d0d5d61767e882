#pragma once

#include <doctest/doctest.h>

#include <vector>

#include "gust/disturb/waveform.h"

namespace gust {

/// A waveform of a kind with some options.
inline Made<Waveform> waveform(const std::string& kind, std::vector<std::pair<std::string, Value>> options = {}) {
  return waveforms().at(kind).make(Table{std::move(options), {"test"}});
}

inline Value number(double value) { return {value, {"test"}}; }
inline Value steps(std::int64_t value) { return {value, {"test"}}; }
inline Value word(std::string value) { return {std::move(value), {"test"}}; }

/// The first values of a waveform at a control rate.
inline std::vector<double> values_of(const Made<Waveform>& made, std::size_t count, double rate = 50,
                                     Rng rng = Rng(0)) {
  std::vector<double> values(count);
  made->fill(values, rate, rng);
  return values;
}

}  // namespace gust
