#include "gust/core/value.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace gust;

namespace {

const Place kPlace{"study.toml", 3, 7};

template <class F>
std::string error_of(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a place is file, line and column, or only a name") {
  CHECK(kPlace.text() == "study.toml:3:7");
  CHECK(Place{"--set"}.text() == "--set");
}

TEST_CASE("a value is read as what it is") {
  CHECK(Value{true, kPlace}.as_bool("on"));
  CHECK(Value{std::int64_t{7}, kPlace}.as_int("steps") == 7);
  CHECK(Value{std::int64_t{7}, kPlace}.as_number("steps") == 7.0);
  CHECK(Value{0.5, kPlace}.as_number("level") == 0.5);
  CHECK(Value{std::string("sine"), kPlace}.as_text("kind") == "sine");
  CHECK(Value{0.5, kPlace}.as_numbers("levels") == std::vector<double>{0.5});
  const Value list{Value::List{{std::int64_t{1}, kPlace}, {2.5, kPlace}}, kPlace};
  CHECK(list.as_numbers("levels") == std::vector<double>{1, 2.5});
  CHECK(list.as_list("levels").size() == 2);
}

TEST_CASE("a value of another type is an error that says where, what and what would be right") {
  const Value text{std::string("fast"), kPlace};
  const Value number{2.5, kPlace};

  CHECK(error_of([&] { text.as_number("rate"); }) == "study.toml:3:7: 'rate' must be a number, got text");
  CHECK(error_of([&] { text.as_bool("on"); }) == "study.toml:3:7: 'on' must be true or false, got text");
  CHECK(error_of([&] { number.as_int("steps"); }) == "study.toml:3:7: 'steps' must be a whole number, got 2.5");
  CHECK(error_of([&] { number.as_text("kind"); }) == "study.toml:3:7: 'kind' must be text, got a number");
  CHECK(error_of([&] { number.as_list("list"); }) == "study.toml:3:7: 'list' must be a list, got a number");
  CHECK(error_of([&] { number.as_table("plant"); }) == "study.toml:3:7: 'plant' must be a table, got a number");
  CHECK(error_of([&] { text.as_numbers("levels"); }) ==
        "study.toml:3:7: 'levels' must be a number or a list of numbers, got text");
}

TEST_CASE("numbers are finite") {
  CHECK(error_of([] {
          Value{NAN, kPlace}.as_number("level");
        }) == "study.toml:3:7: 'level' must be a finite number, got nan");
  CHECK(error_of([] {
          Value{-INFINITY, kPlace}.as_number("level");
        }) == "study.toml:3:7: 'level' must be a finite number, got -inf");
  CHECK(error_of([] { Value{Value::List{{1.0, kPlace}, {NAN, kPlace}}, kPlace}.as_numbers("levels"); }) != "");
}

TEST_CASE("a table keeps its order, replaces in place and forgets") {
  Table table;
  table.set("b", {1.0, kPlace});
  table.set("a", {2.0, kPlace});
  table.set("b", {3.0, kPlace});

  CHECK(table.keys() == std::vector<std::string>{"b", "a"});
  CHECK(table.find("b")->as_number("b") == 3.0);
  CHECK(table.find("c") == nullptr);
  table.erase("b");
  table.erase("c");
  CHECK(table.keys() == std::vector<std::string>{"a"});
}

TEST_CASE("the command line's texts become values") {
  const auto value = [](const char* text) { return value_from_text(text, {"--set"}); };

  CHECK(value("true").as_bool("x"));
  CHECK(value(" -3 ").as_int("x") == -3);
  CHECK(value("1e-3").as_number("x") == 1e-3);
  CHECK(value("sine").as_text("x") == "sine");
  CHECK(value("\"12\"").as_text("x") == "12");
  CHECK(value("[1, 2.5]").as_numbers("x") == std::vector<double>{1, 2.5});
  CHECK(value("1,2").as_numbers("x") == std::vector<double>{1, 2});
  CHECK(value("[]").as_numbers("x").empty());
  CHECK(value("fx,fz").as_list("x")[1].as_text("x") == "fz");
  CHECK(value("1.2.3").as_text("x") == "1.2.3");
  CHECK(value("").as_text("x") == "");
}

TEST_CASE("an unknown key is an error with the nearest known one, or with all of them") {
  Table table{{{"frequncy", Value{1.0, kPlace}}}, {"study.toml", 1, 1}};
  const std::vector<std::string> known = {"frequency", "phase"};

  CHECK(error_of([&] { check_keys(table, known, "sine"); }) ==
        "study.toml:3:7: unknown key 'frequncy' in sine; did you mean 'frequency'?");
  table.items[0].first = "colour";
  CHECK(error_of([&] { check_keys(table, known, "sine"); }) ==
        "study.toml:3:7: unknown key 'colour' in sine; known are frequency, phase");
  table.items[0].first = "phase";
  CHECK(error_of([&] { check_keys(table, known, "sine"); }) == "");
}
