#include "gust/core/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "gust/core/error.h"
#include "gust/core/text.h"

namespace gust {
namespace {

/// Takes a CSV text apart, record by record.
class Reader {
 public:
  Reader(std::string_view text, std::string_view name, std::size_t at = 0, std::size_t line = 1)
      : text_(text), name_(name), at_(at), line_(line) {}

  bool at_end() const { return at_ >= text_.size(); }
  std::size_t line() const { return line_; }
  std::size_t at() const { return at_; }

  std::vector<std::string> record() {
    std::vector<std::string> cells;
    do {
      cells.push_back(cell());
    } while (take(','));
    take('\r');
    if (!at_end() && !take('\n')) throw Error(cat(name_, ":", line_, ": a quoted cell goes on after its quote"));
    ++line_;
    return cells;
  }

 private:
  bool take(char letter) {
    if (at_end() || text_[at_] != letter) return false;
    ++at_;
    return true;
  }

  std::string cell() {
    if (take('"')) return quoted();
    const std::size_t end = std::min(text_.find_first_of(",\r\n", at_), text_.size());
    std::string result(text_.substr(at_, end - at_));
    at_ = end;
    return result;
  }

  std::string quoted() {
    std::string result;
    const std::size_t first = line_;
    while (!at_end()) {
      const char letter = text_[at_++];
      if (letter == '"' && !take('"')) return result;
      line_ += letter == '\n' ? 1 : 0;
      result += letter;
    }
    throw Error(cat(name_, ":", first, ": a quoted cell has no end"));
  }

  std::string_view text_;
  std::string_view name_;
  std::size_t at_;
  std::size_t line_;
};

std::string_view first_line(std::string_view text) { return text.substr(0, text.find_first_of("\r\n")); }

bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

/// "0,5"
bool has_decimal_comma(std::string_view line) {
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    if (line[i] == ',' && is_digit(line[i - 1]) && is_digit(line[i + 1])) return true;
  }
  return false;
}

bool is_number(std::string_view cell) {
  double number = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  return error == std::errc{} && end == cell.data() + cell.size();
}

/// A cell as a number; NaN if it is empty.
double csv_number(const std::string& cell, const std::string& place, std::string_view column) {
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  double number = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  if (error != std::errc{} || end != cell.data() + cell.size())
    throw Error(cat(place, ": '", cell, "' is not a number (column '", column, "')"));
  return number;
}

std::uint64_t csv_whole(const std::string& cell, const std::string& place, std::string_view column) {
  const double value = csv_number(cell, place, column);
  if (!(value >= 0) || value > 9e15 || value != std::floor(value))
    throw Error(cat(place, ": '", cell, "' is no whole number (column '", column, "')"));
  return static_cast<std::uint64_t>(value);
}

}  // namespace

void check_csv_header(std::string_view text, std::string_view name) {
  const std::string_view line = first_line(text);
  if (line.starts_with('#') || line.starts_with('%') || line.starts_with("//")) {
    throw Error(cat(name, ":1:1: begins with a comment, ", line.substr(0, line.starts_with('/') ? 2 : 1),
                    "; the first line must be the names of the columns and nothing else"));
  }
  if (line.starts_with("sep=")) {
    throw Error(cat(name, ":1:1: begins with a line of Excel, ", line.substr(0, 5),
                    "; the first line must be the names of the columns"));
  }
  if (line.size() < text.size() && text[line.size()] == '\r' && text.find('\n') == text.npos)
    throw Error(cat(name, ":1:", line.size() + 1, ": lines end with a carriage return alone; save it with line feeds"));
  const std::vector<std::string> cells = split_text(line, ',');
  const auto number_or_blank = [](std::string_view cell) { return cell.empty() || is_number(cell); };
  if (std::ranges::any_of(cells, is_number) && std::ranges::all_of(cells, number_or_blank))
    throw Error(cat(name, ":1:1: the first line holds numbers; it must hold the names of the columns"));
  if (line.find(',') != std::string_view::npos) return;
  const std::string_view next = first_line(text.substr(std::min(text.size(), text.find('\n', line.size()) + 1)));
  constexpr std::pair<char, std::string_view> kOthers[] = {{';', ";"}, {'\t', "tabs"}, {'|', "|"}, {' ', "blanks"}};
  for (const auto& [separator, word] : kOthers) {
    const std::size_t at = line.find(separator);
    if (at == std::string_view::npos) continue;
    throw Error(cat(name, ":1:", at + 1, ": cells are separated by ", word, " here: commas are needed",
                    has_decimal_comma(next) ? ", and points in numbers" : ""));
  }
}

std::string csv_line_hint(std::string_view line, std::size_t cells, std::size_t of_header) {
  if (line.starts_with('#')) return "; comments are not read, leave them out";
  if (cells > of_header && has_decimal_comma(line)) return "; are these decimal commas? numbers need points";
  return {};
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted(1, '"');
  for (const char letter : text) {
    if (letter == '"') quoted += '"';
    quoted += letter;
  }
  quoted += '"';
  return quoted;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    line += csv_cell(cell);
    line += ',';
  }
  line.back() = '\n';
  return line;
}

CsvReader::CsvReader(std::string_view bytes, std::string_view name) : name_(name), text_(utf8_text(bytes, name)) {
  check_csv_header(text_, name);
  Reader reader(text_, name_);
  if (reader.at_end()) throw Error(cat(name_, ":1: the file is empty"));
  columns_ = reader.record();
  at_ = reader.at();
  next_line_ = reader.line();
}

std::optional<std::size_t> CsvReader::find_column(std::string_view column) const {
  const auto at = std::ranges::find(columns_, column);
  if (at == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - columns_.begin());
}

std::size_t CsvReader::column(std::string_view column) const {
  if (const auto found = find_column(column)) return *found;
  throw Error(cat(name_, ":1: there is no column '", column, "'", did_you_mean(column, columns_)));
}

bool CsvReader::next() {
  Reader reader(text_, name_, at_, next_line_);
  while (!reader.at_end()) {
    line_ = reader.line();
    const std::string_view rest = text_.substr(reader.at());
    cells_ = reader.record();
    at_ = reader.at();
    next_line_ = reader.line();
    if (cells_.size() == 1 && cells_.front().empty() && columns_.size() > 1) continue;
    if (cells_.size() != columns_.size())
      throw Error(cat(place(), ": ", cells_.size(), " cells where the header has ", columns_.size(),
                      csv_line_hint(first_line(rest), cells_.size(), columns_.size())));
    return true;
  }
  return false;
}

double CsvReader::number(std::size_t column) const { return csv_number(cells_[column], place(), columns_[column]); }

std::uint64_t CsvReader::whole(std::size_t column) const {
  return csv_whole(cells_[column], place(), columns_[column]);
}

std::string CsvReader::place() const { return cat(name_, ":", line_); }

CsvTable::CsvTable(std::string_view bytes, std::string_view name) : name_(name) {
  CsvReader reader(bytes, name);
  while (reader.next()) {
    std::vector<std::string>& record = records_.emplace_back();
    for (std::size_t c = 0; c < reader.columns().size(); ++c) record.push_back(reader.text(c));
    lines_.push_back(reader.line());
  }
  columns_ = reader.columns();
}

bool CsvTable::has(std::string_view column) const { return std::ranges::find(columns_, column) != columns_.end(); }

const std::string& CsvTable::text(std::size_t record, std::string_view column) const {
  const auto at = std::ranges::find(columns_, column);
  if (at == columns_.end())
    throw Error(cat(name_, ":1: there is no column '", column, "'", did_you_mean(column, columns_)));
  return records_.at(record)[static_cast<std::size_t>(at - columns_.begin())];
}

double CsvTable::number(std::size_t record, std::string_view column) const {
  return csv_number(text(record, column), place(record), column);
}

std::uint64_t CsvTable::whole(std::size_t record, std::string_view column) const {
  return csv_whole(text(record, column), place(record), column);
}

std::string CsvTable::place(std::size_t record) const { return cat(name_, ":", lines_.at(record)); }

}  // namespace gust
