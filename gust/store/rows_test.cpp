#include "gust/store/rows.h"

#include <doctest/doctest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "gust/core/error.h"
#include "gust/core/rng.h"
#include "gust/store/files_test_folder.h"

using namespace gust;

namespace {

RowsHeader small_header() { return {{"anr", "survival"}, {"nominal", "random"}, 3, 2}; }

/// Cells of numbers as they occur: some random, some constant, one metric of all kinds of odd values.
std::vector<double> sample_cell(const RowsHeader& header, std::uint64_t cell) {
  const double odd[] = {NAN, -0.0, INFINITY, -INFINITY, std::numeric_limits<double>::denorm_min(), -NAN};
  const Rng rng = Rng(7).split(cell);
  std::vector<double> numbers(header.cell_size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = i % 3 == 0 ? 1.0 : i % 3 == 1 ? rng.uniform(i) : odd[rng.below(6, i)];
  }
  return numbers;
}

std::string written(const RowsHeader& header) {
  std::string bytes;
  RowsWriter writer(header, [&](std::string_view piece) { bytes.append(piece); });
  for (std::uint64_t cell = 0; cell < header.cells; ++cell) writer.append_cell(sample_cell(header, cell));
  writer.finish();
  return bytes;
}

/// Bytes of the heap that are in use.
std::size_t heap_in_use() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// Reads everything; returns what went wrong.
std::string complaint_of(const std::string& bytes) {
  return message_of([&] {
    std::istringstream stream(bytes);
    RowsReader reader(stream, "x");
    while (!reader.next().empty()) {
    }
  });
}

}  // namespace

TEST_CASE("rows read back bit for bit, in blocks of many cells and of one") {
  for (const RowsHeader& header :
       {small_header(), RowsHeader{{"a"}, {"s"}, 1, 100'000}, RowsHeader{{"a", "b", "c"}, {"s"}, 40'000, 3}}) {
    std::istringstream stream(written(header));
    RowsReader reader(stream, "x");

    CHECK(reader.header() == header);
    std::uint64_t equal = 0;
    for (std::uint64_t cell = 0; cell < header.cells; ++cell) {
      const std::span<const double> numbers = reader.next();
      const std::vector<double> expected = sample_cell(header, cell);
      REQUIRE(numbers.size() == expected.size());
      equal += std::memcmp(numbers.data(), expected.data(), numbers.size_bytes()) == 0 ? 1 : 0;
    }
    CHECK(equal == header.cells);
    CHECK(reader.next().empty());
    CHECK(reader.next().empty());
  }
}

TEST_CASE("equal cells give equal bytes") { CHECK(written(small_header()) == written(small_header())); }

TEST_CASE("many cells stream through little memory") {
  const RowsHeader header = {{"a", "b", "c", "d"}, {"s", "t"}, 25, 20'000};
  const TestFolder folder;
  std::vector<double> cell(header.cell_size(), 0.5);
  const std::size_t before = heap_in_use();
  std::size_t most = before;

  std::ofstream out(folder / "rows", std::ios::binary);
  RowsWriter writer(header, [&](std::string_view piece) { out << piece; });
  for (std::uint64_t i = 0; i < header.cells; ++i) {
    cell[i % cell.size()] = static_cast<double>(i);
    writer.append_cell(cell);
    if (i % 50 == 0) most = std::max(most, heap_in_use());
  }
  writer.finish();
  out.close();
  std::ifstream in(folder / "rows", std::ios::binary);
  RowsReader reader(in, "rows");
  std::uint64_t cells = 0;
  while (!reader.next().empty()) {
    if (cells++ % 50 == 0) most = std::max(most, heap_in_use());
  }

  CHECK(cells == header.cells);
  CHECK(most - before < 2'000'000);  // the numbers alone are 32 MB
}

TEST_CASE("every damaged byte and every cut of a rows file is noticed") {
  const std::string good = written(small_header());
  REQUIRE(complaint_of(good) == "");
  std::size_t noticed = 0;

  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x10);
    noticed += complaint_of(bad).starts_with("x: ") ? 1 : 0;
    noticed += complaint_of(good.substr(0, i)).starts_with("x: ") ? 1 : 0;
  }

  CHECK(noticed == 2 * good.size());
  CHECK(complaint_of(good + "x") == "x: damaged rows: something follows the last cell");
}

TEST_CASE("rows that could not be read again are not begun") {
  const auto begin = [](const RowsHeader& header) {
    return message_of([&] { RowsWriter(header, [](std::string_view) {}); });
  };

  CHECK(begin({{}, {"s"}, 1, 1}) == "rows of a sweep: 1 to 1000 metrics with names of at most 200 bytes are needed");
  CHECK(begin({{"a"}, {"s"}, 0, 1}) == "rows of a sweep: episodes must be 1 to 8388608 with 1 starts, got 0");
  CHECK(begin({{"a", "b"}, {"s"}, 8'000'000, 1}) ==
        "rows of a sweep: episodes must be 1 to 4194304 with 1 starts, got 8000000");
  CHECK(begin({{"a"}, {"s"}, 1, 0}) == "rows of a sweep: at least one cell is needed");
}
