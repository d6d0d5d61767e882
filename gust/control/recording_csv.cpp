#include "gust/control/recording_csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "gust/core/csv.h"
#include "gust/core/text.h"
#include "gust/core/value.h"

namespace gust {
namespace {

constexpr std::size_t kMostBytes = std::size_t{64} << 20;

/// Cuts the text up to the separator off the front; all of it where there is none.
std::string_view take(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

std::string_view take_line(std::string_view& text) {
  std::string_view line = take(text, '\n');
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// Cuts the first cell off the front of a line, without its quotes.
std::string_view take_cell(std::string_view& line) {
  if (!line.starts_with('"')) return take(line, ',');
  std::size_t end = line.find('"', 1);
  while (end < line.size() && line.substr(end + 1).starts_with('"')) end = line.find('"', end + 2);
  end = std::min(end, line.size());
  const std::string_view cell = line.substr(1, end - 1);
  line.remove_prefix(end);
  take(line, ',');
  return cell;
}

/// A blank at either end of a cell means nothing.
std::string_view trimmed(std::string_view cell) {
  while (cell.starts_with(' ')) cell.remove_prefix(1);
  while (cell.ends_with(' ')) cell.remove_suffix(1);
  return cell;
}

std::size_t count_cells(std::string_view line) {
  if (line.find('"') == line.npos) return static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
  std::size_t cells = line.ends_with(',') ? 1 : 0;
  for (; !line.empty(); ++cells) take_cell(line);
  return cells;
}

std::vector<std::string> header_names(std::string_view line, const std::string& name) {
  constexpr std::size_t kMostColumns = 1000;
  std::vector<std::string> names(count_cells(line));
  if (names.size() > kMostColumns) throw Error(cat(name, ":1:1: more than ", kMostColumns, " columns"));
  for (std::string& column : names) column = trimmed(take_cell(line));
  return names;
}

/// For every column of the header, which wanted one it is; wanted.size() for none.
std::vector<std::size_t> match_columns(const std::vector<std::string>& header, const CsvText& text,
                                       const std::vector<CsvColumn>& wanted) {
  std::vector<std::size_t> matches(header.size(), wanted.size());
  for (std::size_t w = 0; w < wanted.size(); ++w) {
    const Place place{text.name, 1, 1};
    const auto count = std::count(header.begin(), header.end(), wanted[w].name);
    if (count > 1) throw error_at(place, "the column '", wanted[w].name, "' is there ", count, " times");
    if (count == 0) {
      std::vector<std::string> strange;
      for (const std::string& name : header) {
        const auto same = [&](const CsvColumn& column) { return column.name == name; };
        if (std::none_of(wanted.begin(), wanted.end(), same)) strange.push_back(name);
      }
      const std::string meant = nearest(wanted[w].name, strange);
      throw error_at(place, "the column '", wanted[w].name, "' is missing",
                     meant.empty() ? "" : cat("; is it the one called '", meant, "'?"), " (gust validate --help)");
    }
    matches[static_cast<std::size_t>(std::find(header.begin(), header.end(), wanted[w].name) - header.begin())] = w;
  }
  return matches;
}

double read_cell(std::string_view cell, const CsvColumn& column, std::size_t record, const Place& place) {
  if (cell.empty() && record == 0 && column.blank_first) return 0;
  double value = 0;
  const auto [end, failure] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (failure != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) {
    throw error_at(place, "'", column.name, "' must be a finite number, got '", cell.substr(0, 40), "'",
                   cell.find(',') == cell.npos ? "" : "; numbers need points");
  }
  if (const std::string right = column.wrong ? column.wrong(value, record) : ""; !right.empty()) {
    throw error_at(place, "'", column.name, "' must be ", right, ", got ", value);
  }
  return value;
}

void check_records(std::string_view rest, const CsvText& text, std::size_t records) {
  while (rest.ends_with('\n') || rest.ends_with('\r')) rest.remove_suffix(1);
  const auto found = static_cast<std::size_t>(std::count(rest.begin(), rest.end(), '\n')) + (rest.empty() ? 0 : 1);
  if (found == records) return;
  const bool comment = rest.starts_with('#') || rest.find("\n#") != rest.npos;
  throw Error(cat(text.name, ": ", found, " records below the header; 'steps' of its JSON file asks for ", records,
                  ", the reset and one a step", comment ? "; comments are not read, leave them out" : ""));
}

}  // namespace

std::vector<std::string> csv_header(const CsvText& text) {
  if (text.bytes.size() > kMostBytes)
    throw Error(cat(text.name, ": ", text.bytes.size(), " bytes; at most ", kMostBytes));
  std::string_view rest = utf8_text(text.bytes, text.name);
  check_csv_header(rest, text.name);
  return header_names(take_line(rest), text.name);
}

Matrix<double> read_csv(const CsvText& text, const std::vector<CsvColumn>& columns, std::size_t records) {
  const std::vector<std::string> header = csv_header(text);
  const std::vector<std::size_t> matches = match_columns(header, text, columns);
  std::string_view rest = utf8_text(text.bytes, text.name);
  take_line(rest);
  check_records(rest, text, records);

  Matrix<double> values(columns.size(), records);
  for (std::size_t record = 0; record < records; ++record) {
    const std::string_view line = take_line(rest);
    Place place{text.name, static_cast<std::uint32_t>(record + 2), 1};
    const std::size_t cells = count_cells(line);
    if (cells != header.size()) {
      throw error_at(place, cells, " cells; the header has ", header.size(), csv_line_hint(line, cells, header.size()));
    }
    std::string_view left = line;
    for (const std::size_t match : matches) {
      place.column = static_cast<std::uint32_t>(left.data() - line.data() + 1);
      const std::string_view cell = trimmed(take_cell(left));
      if (match < columns.size()) values.at(match, record) = read_cell(cell, columns[match], record, place);
    }
  }
  return values;
}

}  // namespace gust
