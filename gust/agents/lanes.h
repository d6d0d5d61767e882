#pragma once

#include <span>

#include "gust/core/rows.h"

namespace gust {

// Between batches of the loop (components x lanes, double) and of the networks (lanes x components, float).

inline void to_lanes(Rows<const double> from, std::span<float> to) {
  for (std::size_t i = 0; i < from.rows; ++i)
    for (std::size_t lane = 0; lane < from.lanes; ++lane)
      to[lane * from.rows + i] = static_cast<float>(from.at(i, lane));
}

inline void to_rows(std::span<const float> from, Rows<double> to) {
  for (std::size_t i = 0; i < to.rows; ++i)
    for (std::size_t lane = 0; lane < to.lanes; ++lane) to.at(i, lane) = from[lane * to.rows + i];
}

}  // namespace gust
