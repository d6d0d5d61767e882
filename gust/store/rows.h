#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gust {

/// What the rows of a sweep trial are: for each cell in order, each start, each episode, the value of each metric.
struct RowsHeader {
  std::vector<std::string> metrics;
  std::vector<std::string> starts;
  std::uint64_t episodes = 0;  ///< per start and cell
  std::uint64_t cells = 0;

  /// Numbers in a cell: starts × episodes × metrics, the metric running fastest.
  std::size_t cell_size() const { return starts.size() * static_cast<std::size_t>(episodes) * metrics.size(); }
  /// Where a metric stands in `metrics`; none if these rows lack it, as those of another version may.
  std::optional<std::size_t> column(std::string_view metric) const;
  bool operator==(const RowsHeader&) const = default;
};

/// What makes a header one that no file can have, or an empty text.
std::string complaint(const RowsHeader& header);

/// Takes the next bytes of a file: `[&](std::string_view bytes) { file.append(bytes); }`.
using ByteSink = std::function<void(std::string_view)>;

/// Writes the rows of a sweep cell by cell, in compressed blocks; memory does not grow with the number of cells.
/// Equal cells give equal bytes. Layout: docs/formats.md.
class RowsWriter {
 public:
  /// Writes the header. What would not be readable again (no metrics, a cell above 64 MiB) is an Error.
  RowsWriter(RowsHeader header, ByteSink sink);

  /// Adds a cell: [start][episode][metric], cell_size() numbers, any bits.
  void append_cell(std::span<const double> cell);
  /// Writes the last block. All cells that the header promised must have come.
  void finish();

 private:
  void write_block();

  RowsHeader header_;
  ByteSink sink_;
  std::uint64_t appended_ = 0;
  std::vector<double> block_;  ///< whole cells, waiting
};

/// Reads such a file cell by cell, bit for bit what was appended; memory does not grow with the number of cells.
/// Damage, and sizes that cannot be, are Errors that begin with the file's name.
class RowsReader {
 public:
  /// Reads the header. The stream must outlive the reader.
  RowsReader(std::istream& stream, std::string name);

  const RowsHeader& header() const { return header_; }
  /// The next cell, valid until the next call; empty after the last one.
  std::span<const double> next();

 private:
  void read_block();

  std::istream& stream_;
  std::string name_;
  RowsHeader header_;
  std::uint64_t read_ = 0;     ///< cells in the blocks so far
  std::vector<double> block_;  ///< the block at hand
  std::size_t position_ = 0;   ///< of the next cell in it
};

/// Reads the header and the heads of the blocks, and checks that all cells are there and nothing follows. Numbers are
/// not looked at.
RowsHeader skim_rows(std::istream& stream, std::string_view name);

}  // namespace gust
