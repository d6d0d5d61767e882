#pragma once

#include <span>
#include <string>

namespace gust {

/// How a chart is drawn in a terminal.
struct ChartStyle {
  std::size_t columns = 69;  ///< of the drawing; the labels before it take 11 more
  std::size_t rows = 5;
  bool unicode = true;  ///< dots of Braille patterns, two by four a character; else stars
};

/// Draws a curve over its index, with the least and greatest value at the left. Where many values share a column, the
/// whole span between the least and the greatest of them is drawn. NaN and infinities are left out.
std::string terminal_chart(std::span<const double> values, const ChartStyle& style);

/// Whether the user's locale says that text is UTF-8.
bool locale_is_utf8();

}  // namespace gust
