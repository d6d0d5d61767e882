#include "gust/core/csv.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "gust/core/error.h"

using namespace gust;

TEST_CASE("what is written as cells is read back, whatever it holds") {
  const std::vector<std::string> cells = {"plain", "a, b", "say \"so\"", "two\nlines", "", "θ"};
  const CsvTable table("c0,c1,c2,c3,c4,c5\n" + csv_line(cells) + csv_line(cells), "cells.csv");

  REQUIRE(table.size() == 2);
  for (std::size_t i = 0; i < cells.size(); ++i) CHECK(table.text(1, cat("c", i)) == cells[i]);
  CHECK(table.place(1) == "cells.csv:4");  // the first record has a cell of two lines
}

TEST_CASE("numbers of cells are exact, and empty ones are none") {
  const CsvTable table("x,y\r\n0.1,\r\n-inf,1e300", "numbers.csv");

  CHECK(table.number(0, "x") == 0.1);
  CHECK(std::isnan(table.number(0, "y")));
  CHECK(table.number(1, "x") == -std::numeric_limits<double>::infinity());
  CHECK(table.number(1, "y") == 1e300);
  CHECK_THROWS_WITH_AS(table.whole(0, "x"), "numbers.csv:2: '0.1' is no whole number (column 'x')", Error);
  CHECK_THROWS_WITH_AS(table.whole(0, "y"), "numbers.csv:2: '' is no whole number (column 'y')", Error);
  CHECK(CsvTable("n\n12\n", "n.csv").whole(0, "n") == 12);
  CHECK(table.has("x"));
  CHECK_FALSE(table.has("z"));
}

TEST_CASE("what is no CSV file is an error with its line") {
  const auto wrong = [](const char* text, const char* message) {
    CHECK_THROWS_WITH_AS(CsvTable(text, "t.csv"), message, Error);
  };
  wrong("", "t.csv:1: the file is empty");
  wrong("a,b\n1\n", "t.csv:2: 1 cells where the header has 2");
  wrong("a\n\"x", "t.csv:2: a quoted cell has no end");
  wrong("a\n\"x\"y\n", "t.csv:2: a quoted cell goes on after its quote");
  const CsvTable table("level\n1\nhigh\n", "t.csv");
  CHECK_THROWS_WITH_AS(table.text(0, "levels"), "t.csv:1: there is no column 'levels'; did you mean 'level'?", Error);
  CHECK_THROWS_WITH_AS(table.number(1, "level"), "t.csv:3: 'high' is not a number (column 'level')", Error);
}

TEST_CASE("another separator, encoding, comment or header is told as what it is") {
  const auto wrong = [](std::string_view text, const char* message) {
    CHECK_THROWS_WITH_AS(CsvTable(text, "t.csv"), message, Error);
  };
  using namespace std::string_view_literals;
  wrong("a;b\n1.5;2\n", "t.csv:1:2: cells are separated by ; here: commas are needed");
  wrong("a;b\n1,5;2\n", "t.csv:1:2: cells are separated by ; here: commas are needed, and points in numbers");
  wrong("a\tb\r\n1,5\t2\n", "t.csv:1:2: cells are separated by tabs here: commas are needed, and points in numbers");
  wrong("a|b\n", "t.csv:1:2: cells are separated by | here: commas are needed");
  wrong("# run 5\na,b\n",
        "t.csv:1:1: begins with a comment, #; the first line must be the names of the columns and nothing else");
  wrong("sep=,\na,b\n1,2\n",
        "t.csv:1:1: begins with a line of Excel, sep=,; the first line must be the names of the columns");
  wrong("sep=;\r\na;b\r\n",
        "t.csv:1:1: begins with a line of Excel, sep=;; the first line must be the names of the columns");
  wrong("a,b\r1,2\r", "t.csv:1:4: lines end with a carriage return alone; save it with line feeds");
  wrong("1.5,,2e3\n", "t.csv:1:1: the first line holds numbers; it must hold the names of the columns");
  wrong("a,b\n1,2\n# pause\n", "t.csv:3: 1 cells where the header has 2; comments are not read, leave them out");
  wrong("a,b\n1,5,2,5\n", "t.csv:2: 4 cells where the header has 2; are these decimal commas? numbers need points");
  wrong(
      "\xff\xfe"
      "a\0,\0"sv,
      "t.csv:1:1: is UTF-16; save it as UTF-8");
  wrong("\0a\0,"sv, "t.csv:1:1: is UTF-16; save it as UTF-8");
}

TEST_CASE("a byte order mark and empty lines change nothing") {
  const CsvTable table(
      "\xef\xbb\xbf"
      "a,b\n\n1,2\n\r\n3,4\n\n",
      "t.csv");

  REQUIRE(table.size() == 2);
  CHECK(table.number(0, "a") == 1);
  CHECK(table.number(1, "b") == 4);
  CHECK(table.place(1) == "t.csv:5");
}
