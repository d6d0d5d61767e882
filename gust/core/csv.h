#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gust {

/// A text as one cell of a CSV file, quoted where it must be (RFC 4180).
std::string csv_cell(const std::string& text);

/// The cells as one line, with its end.
std::string csv_line(const std::vector<std::string>& cells);

/// Throws Error, which begins with the name and the place, where the first line is no header of a CSV file: where cells
/// are separated by something else than commas, where it is a comment, or where it holds numbers alone.
void check_csv_header(std::string_view text, std::string_view name);

/// What may be wrong with a line that has another number of cells than the header, as "; …" for the end of a message;
/// empty if nothing is known.
std::string csv_line_hint(std::string_view line, std::size_t cells, std::size_t of_header);

/// Reads a CSV file record by record: a header line, then records; UTF-8, cells may be quoted, and empty lines are left
/// out. The text must outlive it. Errors begin with the name and the line.
class CsvReader {
 public:
  /// Reads the header. Throws Error where the text is no such file.
  CsvReader(std::string_view bytes, std::string_view name);

  const std::vector<std::string>& columns() const { return columns_; }
  std::optional<std::size_t> find_column(std::string_view column) const;
  /// Throws Error with the nearest name if there is no such column.
  std::size_t column(std::string_view column) const;

  /// Reads the next record; false after the last. Throws Error if it has more or fewer cells than the header.
  bool next();
  const std::string& text(std::size_t column) const { return cells_[column]; }
  /// The cell as a number; NaN if it is empty. Throws Error if it is none.
  double number(std::size_t column) const;
  /// The cell as a whole number, 0 or more. Throws Error if it is none.
  std::uint64_t whole(std::size_t column) const;
  /// "name:line" of the record, for messages.
  std::string place() const;
  std::size_t line() const { return line_; }

 private:
  std::string name_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t next_line_ = 1;
  std::size_t line_ = 1;
  std::vector<std::string> columns_;
  std::vector<std::string> cells_;
};

/// The same with all records in memory.
class CsvTable {
 public:
  /// Throws Error, which begins with the name and the line, where the text is no such file or a record has more or
  /// fewer cells than the header.
  CsvTable(std::string_view bytes, std::string_view name);

  std::size_t size() const { return records_.size(); }
  bool has(std::string_view column) const;
  /// A cell of a record. Throws Error if there is no such column.
  const std::string& text(std::size_t record, std::string_view column) const;
  /// The cell as a number; NaN if it is empty. Throws Error with the line if it is none.
  double number(std::size_t record, std::string_view column) const;
  /// The cell as a whole number, 0 or more. Throws Error with the line if it is none.
  std::uint64_t whole(std::size_t record, std::string_view column) const;
  /// "name:line", for messages.
  std::string place(std::size_t record) const;

 private:
  std::string name_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> records_;
  std::vector<std::size_t> lines_;
};

}  // namespace gust
