#include "gust/setup/toml.h"

#include <doctest/doctest.h>

namespace gust {
namespace {

std::string error_of(std::string_view bytes) {
  try {
    parse_toml(bytes, "s.toml");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

bool starts(const std::string& text, std::string_view with) { return text.substr(0, with.size()) == with; }

TEST_CASE("TOML keeps the order of the text and knows where each value stands") {
  const Table table = parse_toml("zeta = 1\nalpha = [1.5, \"x\"]\n\n[mid]\nb = true\na = { y = 1, x = 2 }\n", "s.toml");

  CHECK(table.keys() == std::vector<std::string>{"zeta", "alpha", "mid"});
  CHECK(table.find("zeta")->as_int("zeta") == 1);
  CHECK(table.find("zeta")->place.text() == "s.toml:1:8");
  const auto& list = table.find("alpha")->as_list("alpha");
  CHECK(list[0].as_number("alpha") == 1.5);
  CHECK(list[1].as_text("alpha") == "x");
  CHECK(list[1].place.text() == "s.toml:2:15");
  const Table& mid = table.find("mid")->as_table("mid");
  CHECK(mid.place.text() == "s.toml:4:1");
  CHECK(mid.keys() == std::vector<std::string>{"b", "a"});
  CHECK(mid.find("a")->as_table("a").keys() == std::vector<std::string>{"y", "x"});
}

TEST_CASE("TOML arrays of tables and dotted keys become nested tables in order") {
  const Table table = parse_toml("b.second = 2\nb.first = 1\n[[row]]\nn = 1\n[[row]]\nn = 2\n", "s.toml");

  const Table& b = table.find("b")->as_table("b");
  CHECK(b.keys() == std::vector<std::string>{"second", "first"});
  CHECK(b.place.line == 1);
  const auto& rows = table.find("row")->as_list("row");
  REQUIRE(rows.size() == 2);
  CHECK(rows[1].as_table("row").find("n")->as_int("n") == 2);
  CHECK(rows[1].place.line == 5);
}

TEST_CASE("a text that is not TOML is an error with its place") {
  CHECK(starts(error_of("a = 1\nb = \n"), "s.toml:2:"));
  CHECK(starts(error_of("a = 1\na = 2\n"), "s.toml:2:"));
  CHECK(starts(error_of("a = \"open\nb = 1\n"), "s.toml:1:"));
  CHECK(starts(error_of("a = 'x'\nb = \"\xff\xfe\"\n"), "s.toml:2:"));
  CHECK(starts(error_of(std::string_view("a = 1\n\0b = 2\n", 13)), "s.toml:2:"));
  CHECK(starts(error_of("a = 99999999999999999999\n"), "s.toml:1:"));
  CHECK(starts(error_of("[a]\n[a]\n"), "s.toml:2:"));
}

TEST_CASE("TOML dates are refused where they stand") {
  CHECK(starts(error_of("a = 1\nwhen = 2022-10-26\n"), "s.toml:2:8: dates"));
  CHECK(starts(error_of("at = 10:00:00\n"), "s.toml:1:6: dates"));
}

TEST_CASE("TOML nested beyond reason is refused before it costs stack") {
  std::string dotted = "a";
  for (int i = 0; i < 200'000; ++i) dotted += ".a";
  CHECK(starts(error_of("x = 1\n" + dotted + " = 1\n"), "s.toml:2:1: a key has more than"));
  CHECK(starts(error_of("[" + dotted + "]\n"), "s.toml:1:1: a key has more than"));

  std::string quoted = "\"=\"";
  for (int i = 0; i < 100; ++i) quoted += ".'#'.\"\\\"=\"";
  CHECK(starts(error_of("s = \"\"\"x = ' \"\"\"\"\"\n" + quoted + " = 1\n"), "s.toml:2:1: a key has more than"));

  CHECK(starts(error_of("a = " + std::string(100'000, '[')), "s.toml:1:"));
  std::string mixed = "x = ";
  for (int i = 0; i < 20; ++i) mixed += "{a.b.c.d = ";
  mixed += "1" + std::string(20, '}') + "\n";
  CHECK(error_of(mixed).find("nested more than 32 deep") != std::string::npos);
}

TEST_CASE("a TOML header without a key is one error with its place") {
  for (const std::string header : {"[=]", "[[=", "[+]", "[.a]", "[{", "[#", "[[[", "[ \n]", "[\x01]", "[a.=]", "["}) {
    CAPTURE(header);
    CHECK(starts(error_of("x = 1\n" + header), "s.toml:2:"));
  }
  CHECK(starts(error_of("x = 1\n[[" + std::string(3, '\0')), "s.toml:2:"));
}

TEST_CASE("TOML letters beyond ASCII are text within quotes and an error elsewhere, whatever their script") {
  for (const std::string letter : {"é", "θ", "ж", "ꙮ", "日", "，", "“", "ﻼ", "\uFEFE", "😀"}) {
    CAPTURE(letter);
    const Table table =
        parse_toml("a = \"" + letter + "\"\nb = \"\"\"\\\n  " + letter + "\"\"\" # " + letter, "s.toml");
    CHECK(table.find("a")->as_text("a") == letter);
    CHECK(table.find("b")->as_text("b") == letter);
    CHECK(starts(error_of("a = 1\n" + letter + " = 1\n"), "s.toml:2:"));
    CHECK(starts(error_of("a = 1\nb" + letter + " = 1\n"), "s.toml:2:"));
    CHECK(starts(error_of("a = 1\nb = 1" + letter + "\n"), "s.toml:2:"));
    CHECK(starts(error_of("a = 1\nb = \"\\" + letter + "\"\n"), "s.toml:2:"));
  }
}

TEST_CASE("TOML text with many dots in strings, comments and lists of numbers is no deep key") {
  std::string text = "# " + std::string(100, '.') + "\na = \"" + std::string(100, '.') + "\"\nb = '''" +
                     std::string(100, '.') + "'''\nc = [0.1";
  for (int i = 0; i < 100; ++i) text += ", 0.1";

  const Table table = parse_toml(text + "]\n", "s.toml");

  CHECK(table.find("c")->as_numbers("c").size() == 101);
}

TEST_CASE("TOML of more than a mebibyte is refused") {
  CHECK(error_of(std::string((1 << 20) + 1, '\n')).find("at most 1048576") != std::string::npos);
  CHECK(error_of(std::string(1 << 20, '\n')) == "no error");
}

TEST_CASE("TOML that is empty is an empty table") {
  CHECK(parse_toml("", "s.toml").items.empty());
  CHECK(parse_toml("\xEF\xBB\xBF# only a comment, after a byte order mark", "s.toml").items.empty());
}

}  // namespace
}  // namespace gust
