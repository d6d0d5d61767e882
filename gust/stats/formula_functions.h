#pragma once

#include "gust/stats/formula.h"

namespace gust {

/// A function of values alone: what it is called with and what it gives.
struct FormulaFunction {
  std::string_view name;
  std::string_view arguments;  ///< "list, list"
  std::string_view summary;
  std::size_t least = 1;  ///< how many arguments it takes
  std::size_t most = 1;
  FormulaValue (*call)(const std::vector<FormulaValue>& arguments) = nullptr;
};

/// All of them: means and extremes, areas, thresholds and fits of curves, rank correlations.
std::span<const FormulaFunction> formula_functions();

}  // namespace gust
