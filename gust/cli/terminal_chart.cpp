#include "gust/cli/terminal_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace gust {
namespace {

/// A raster of dots, row 0 at the top.
class Dots {
 public:
  Dots(std::size_t width, std::size_t height) : width_(width), height_(height), on_(width * height) {}

  std::size_t width() const { return width_; }
  std::size_t height() const { return height_; }
  bool at(std::size_t x, std::size_t y) const { return on_[y * width_ + x]; }
  void line(std::size_t x, std::size_t top, std::size_t bottom) {
    for (std::size_t y = top; y <= bottom; ++y) on_[y * width_ + x] = true;
  }

 private:
  std::size_t width_;
  std::size_t height_;
  std::vector<bool> on_;
};

struct Bounds {
  double low = 0;
  double high = 0;
};

Bounds bounds_of(std::span<const double> values) {
  Bounds bounds;  // zero is always in the picture
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    bounds.low = std::min(bounds.low, value);
    bounds.high = std::max(bounds.high, value);
  }
  return bounds;
}

std::size_t height_of(double value, const Bounds& bounds, std::size_t height) {
  const double span = bounds.high - bounds.low;
  const double from_top = span > 0 ? (bounds.high - value) / span : 1.0;
  return static_cast<std::size_t>(std::lround(from_top * static_cast<double>(height - 1)));
}

void draw(std::span<const double> values, const Bounds& bounds, Dots& dots) {
  std::size_t before = 0;
  bool begun = false;
  for (std::size_t x = 0; x < dots.width(); ++x) {
    const std::size_t first = x * values.size() / dots.width();
    const std::size_t last = std::max(first + 1, (x + 1) * values.size() / dots.width());
    for (std::size_t i = first; i < std::min(last, values.size()); ++i) {
      if (!std::isfinite(values[i])) continue;
      const std::size_t y = height_of(values[i], bounds, dots.height());
      dots.line(x, begun ? std::min(y, before) : y, begun ? std::max(y, before) : y);
      before = y;
      begun = true;
    }
  }
}

/// The Braille pattern of two by four dots, in UTF-8.
std::string braille(const Dots& dots, std::size_t column, std::size_t row) {
  static constexpr int kBit[4][2] = {{0, 3}, {1, 4}, {2, 5}, {6, 7}};
  unsigned pattern = 0;
  for (std::size_t y = 0; y < 4; ++y) {
    for (std::size_t x = 0; x < 2; ++x) {
      if (dots.at(2 * column + x, 4 * row + y)) pattern |= 1u << kBit[y][x];
    }
  }
  return {'\xe2', static_cast<char>(0xa0 + (pattern >> 6)), static_cast<char>(0x80 + (pattern & 63))};
}

}  // namespace

std::string terminal_chart(std::span<const double> values, const ChartStyle& style) {
  Dots dots(style.columns * (style.unicode ? 2 : 1), style.rows * (style.unicode ? 4 : 1));
  const Bounds bounds = bounds_of(values);
  draw(values, bounds, dots);
  std::string text;
  for (std::size_t row = 0; row < style.rows; ++row) {
    const bool top = row == 0;
    const bool bottom = row + 1 == style.rows;
    text += top      ? fmt::format("{:>9.4g} ", bounds.high)
            : bottom ? fmt::format("{:>9.4g} ", bounds.low)
                     : std::string(10, ' ');
    text += style.unicode ? (top ? "\u2524" : bottom ? "\u2524" : "\u2502") : (top || bottom ? "+" : "|");
    for (std::size_t column = 0; column < style.columns; ++column) {
      text += style.unicode ? braille(dots, column, row) : dots.at(column, row) ? "*" : " ";
    }
    while (text.ends_with(' ')) text.pop_back();
    text += '\n';
  }
  return text;
}

bool locale_is_utf8() {
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(variable);
    if (value == nullptr || *value == '\0') continue;
    const std::string_view text = value;
    return text.find("UTF-8") != std::string_view::npos || text.find("utf8") != std::string_view::npos;
  }
  return false;
}

}  // namespace gust
