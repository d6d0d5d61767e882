#include "gust/core/fields.h"

#include <doctest/doctest.h>

using namespace gust;

namespace {

struct Kettle {
  bool lid = true;
  std::int64_t cups = 2;
  double heat = 1.5;
  std::string colour = "red";
  std::vector<double> weights = {1, 2};
  bool whistle = false;

  static constexpr std::tuple kFields = {
      field("lid", &Kettle::lid, "whether it is shut"),
      field("cups", &Kettle::cups, "how much it holds", between(1, 8)),
      field("heat", &Kettle::heat, "power", positive, "kW"),
      field("colour", &Kettle::colour, "what it looks like", one_of("red|blue")),
      field("weights", &Kettle::weights, "anything", non_negative),
      later(field("whistle", &Kettle::whistle, "whether it is heard")),
  };

  void check(const Place& place) const {
    if (!lid && heat > 2) throw error_at(place, "'heat' must be at most 2 without a lid, got ", heat);
  }
};

const Place kPlace{"study.toml", 9, 12};

Kettle read(const char* key, Value value) {
  Kettle kettle;
  value.place = kPlace;
  read_fields(kettle, Table{{{key, std::move(value)}}, {"study.toml", 9, 1}}, "kettle", {"kind"});
  return kettle;
}

std::string error_of(const char* key, Value value) {
  try {
    read(key, std::move(value));
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("fields take what the table gives and keep the rest") {
  const Kettle kettle = read("heat", {std::int64_t{2}, {}});

  CHECK(kettle.heat == 2.0);
  CHECK(kettle.cups == 2);
  CHECK(read("lid", {false, {}}).lid == false);
  CHECK(read("colour", {std::string("blue"), {}}).colour == "blue");
  CHECK(read("weights", {3.0, {}}).weights == std::vector<double>{3});
  CHECK(read("kind", {std::string("kettle"), {}}).cups == 2);
}

TEST_CASE("a value outside its range is an error that names the range") {
  CHECK(error_of("heat", {0.0, {}}) == "study.toml:9:12: 'heat' must be > 0, got 0");
  CHECK(error_of("cups", {std::int64_t{9}, {}}) == "study.toml:9:12: 'cups' must be 1 to 8, got 9");
  CHECK(error_of("cups", {2.0, {}}) == "study.toml:9:12: 'cups' must be a whole number, got 2");
  CHECK(error_of("weights", {Value::List{{1.0, kPlace}, {-1.0, kPlace}}, {}}) ==
        "study.toml:9:12: 'weights' must be >= 0, got -1");
  CHECK(error_of("colour", {std::string("bleu"), {}}) ==
        "study.toml:9:12: 'colour' must be one of red, blue, got 'bleu'; did you mean 'blue'?");
  CHECK(error_of("head", {1.0, {}}) == "study.toml:9:12: unknown key 'head' in kettle; did you mean 'heat'?");
}

TEST_CASE("a check over several fields speaks for the whole table") {
  Kettle kettle;
  const Table table{{{"lid", Value{false, kPlace}}, {"heat", Value{3.0, kPlace}}}, {"study.toml", 9, 1}};

  CHECK_THROWS_WITH_AS(read_fields(kettle, table, "kettle"),
                       "study.toml:9:1: 'heat' must be at most 2 without a lid, got 3", Error);
}

TEST_CASE("equal options have equal canonical texts, whatever way they were written") {
  CHECK(canonical_fields(Kettle{}) == "lid = true, cups = 2, heat = 1.5, colour = \"red\", weights = [1, 2]");
  const std::string loud = canonical_fields(read("whistle", {true, {}}));
  CHECK(loud.ends_with("weights = [1, 2], whistle = true"));  // a later field at its default leaves the text as it was
  CHECK(canonical_text(-0.0) == "0");
  CHECK(canonical_text(std::string("a\"b\\c")) == "\"a\\\"b\\\\c\"");
  CHECK(canonical_text(0.1) == "0.1");
  CHECK(canonical_text(1e300) == "1e+300");
}

TEST_CASE("the catalogue shows name, type, unit, range, default and help of every field") {
  const std::vector<FieldInfo> infos = describe_fields<Kettle>();

  REQUIRE(infos.size() == 6);
  CHECK(infos[2].name == "heat");
  CHECK(infos[2].type == "number");
  CHECK(infos[2].unit == "kW");
  CHECK(infos[2].range == "> 0");
  CHECK(infos[2].standard == "1.5");
  CHECK(infos[2].help == "power");
  CHECK(infos[1].range == "1 to 8");
  CHECK(infos[3].range == "one of red, blue");
  CHECK(infos[4].type == "list of numbers");
  CHECK(field_names<Kettle>() == std::vector<std::string>{"lid", "cups", "heat", "colour", "weights", "whistle"});
}

TEST_CASE("a range says in words what it contains") {
  CHECK(anything.text() == "");
  CHECK(at_least(2).text() == ">= 2");
  CHECK(Range{.low = 0, .high = 1, .low_open = true}.text() == "above 0 to 1");
  CHECK(Range{.high = 3}.text() == "<= 3");
  CHECK(positive.contains(1e-300));
  CHECK_FALSE(positive.contains(0));
  CHECK(non_negative.contains(0));
  CHECK(between(0, 1).contains(1));
  CHECK_FALSE(between(0, 1).contains(1.5));
}
