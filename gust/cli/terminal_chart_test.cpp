#include "gust/cli/terminal_chart.h"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

namespace gust {
namespace {

constexpr ChartStyle kSmall{.columns = 4, .rows = 3, .unicode = false};

TEST_CASE("a chart in stars puts the greatest value at the top and joins what jumps") {
  CHECK(terminal_chart(std::vector<double>{0, 0, 2, 2}, kSmall) ==
        "        2 +  **\n"
        "          |  *\n"
        "        0 +***\n");
}

TEST_CASE("a chart always shows zero") {
  CHECK(terminal_chart(std::vector<double>{-1, -1, -1, -1}, kSmall) ==
        "        0 +\n"
        "          |\n"
        "       -1 +****\n");
  CHECK(terminal_chart(std::vector<double>{0, 0, 0, 0}, kSmall) ==
        "        0 +\n"
        "          |\n"
        "        0 +****\n");
}

TEST_CASE("a chart draws the whole span of the values that share a column") {
  CHECK(terminal_chart(std::vector<double>{1, -1, 1, -1, 1, -1, 1, -1}, kSmall) ==
        "        1 +****\n"
        "          |****\n"
        "       -1 +****\n");
}

TEST_CASE("a chart leaves out NaN and infinities, and few values fill it") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(terminal_chart(std::vector<double>{nan, nan, 1, 1}, kSmall) ==
        "        1 +  **\n"
        "          |\n"
        "        0 +\n");
  CHECK(terminal_chart(std::vector<double>{1}, kSmall).substr(0, 15) == "        1 +****");
}

TEST_CASE("a chart in Braille has two by four dots a character") {
  const std::string text = terminal_chart(std::vector<double>{0, 1}, {.columns = 1, .rows = 2, .unicode = true});

  CHECK(text == "        1 \u2524\u28B8\n        0 \u2524\u28F8\n");  // the right column full, the left one its foot
}

}  // namespace
}  // namespace gust
