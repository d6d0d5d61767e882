#include "gust/control/recording_json.h"

#include <doctest/doctest.h>

using namespace gust;

namespace {

std::string error_of(const std::string& text) {
  try {
    read_json_table(text, "a.json");
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("values keep their types, their order and their places") {
  const Table table = read_json_table("{\"b\": 1,\n \"a\" : [true,2.5 , \"x\\u00e9,\"],\"t\":{\"n\":-7}}", "a.json");

  CHECK(table.keys() == std::vector<std::string>{"b", "a", "t"});
  CHECK(table.find("b")->as_int("b") == 1);
  CHECK(table.find("b")->place.text() == "a.json:1:7");
  const Value::List& list = table.find("a")->as_list("a");
  CHECK(list[0].as_bool("") == true);
  CHECK(list[0].place.text() == "a.json:2:9");
  CHECK(list[1].as_number("") == 2.5);
  CHECK(list[1].place.text() == "a.json:2:14");
  CHECK(list[2].as_text("") == "x\xc3\xa9,");
  CHECK(list[2].place.text() == "a.json:2:20");
  CHECK(table.find("t")->as_table("").find("n")->as_int("") == -7);
  CHECK(table.find("t")->as_table("").find("n")->place.text() == "a.json:2:41");
}

TEST_CASE("null counts as absent, and whole numbers beyond 64 bits become floating point") {
  const Table table =
      read_json_table("{\"a\": null, \"b\": 18446744073709551615, \"c\": 100000000000000000000}", "a.json");

  CHECK_FALSE(table.contains("a"));
  CHECK(table.find("b")->as_number("b") == 0x1p64);
  CHECK(table.find("c")->as_number("c") == 1e20);
}

TEST_CASE("text that is no JSON object gives one error with its place") {
  CHECK(error_of("").starts_with("a.json:1:1: not valid JSON: "));
  CHECK(error_of("[1, 2]") == "a.json:1:1: must be a JSON object, { … }, got a list");
  CHECK(error_of("null").starts_with("a.json:1:1: must be a JSON object"));
  CHECK(error_of("{\"a\": 1\n \"b\": 2}").starts_with("a.json:2:2: not valid JSON: "));
  CHECK(error_of("{\"a\": NaN}").starts_with("a.json:1:7: not valid JSON: "));
  CHECK(error_of("{\"a\": 1e999}").starts_with("a.json:1:7: not valid JSON: "));
  CHECK(error_of("{\"a\": [null]}") == "a.json:1:8: a list must not hold null");
  CHECK(error_of("{\"a\": 1,\n\"a\": 2}") == "a.json:2:1: 'a' is there twice");
  CHECK(error_of("{\"a\": 1} x").starts_with("a.json:1:10: not valid JSON: "));
}

TEST_CASE("depth and size are bounded") {
  CHECK(error_of("{\"a\": " + std::string(100'000, '[')) == "a.json:1:14: nested deeper than 8 levels");
  CHECK(error_of(std::string(300'000, ' ')).starts_with("a.json: 300000 bytes; "));
}
