#include "gust/report/json_writer.h"

#include <doctest/doctest.h>

#include <array>
#include <limits>

namespace gust {

TEST_CASE("the JSON writer places commas between members and elements") {
  JsonWriter json;

  json.open('{').key("a").index(1).key("b").open('[').flag(true).text("x").open('{').close('}').close(']').close('}');

  CHECK(json.str() == R"({"a":1,"b":[true,"x",{}]})");
}

TEST_CASE("numbers keep five digits, and those that JSON lacks still read in JavaScript") {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  JsonWriter json;

  json.numbers(std::array{0.0, -0.0, 0.123456789, 1e-9, 250.0, -2.5, kInfinity, -kInfinity, kInfinity - kInfinity});

  CHECK(json.str() == "[0,0,0.12346,1e-09,250,-2.5,1e999,-1e999,null]");
}

TEST_CASE("a text in JSON cannot end the script element that it stands in") {
  JsonWriter json;

  json.text("</script><!-- \"quoted\" \\ \n\t \xFF");

  CHECK(json.str() == "\"\\u003c/script>\\u003c!-- \\\"quoted\\\" \\\\ \\n\\t �\"");
}

}  // namespace gust
