#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "gust/core/rows.h"

namespace gust {

/// A column that a CSV file must have.
struct CsvColumn {
  std::string name;
  bool blank_first = false;  ///< the cell of the first record may be empty; it then reads as 0
  /// What the value of a record would have to be, or an empty text if it is right.
  std::function<std::string(double value, std::size_t record)> wrong = {};
};

/// The text of a CSV file in UTF-8: one header line, then one record a line; cells are separated by commas, and may be
/// quoted or have blanks around them.
struct CsvText {
  std::string_view bytes;
  std::string name;
};

/// The names of a file's columns. Throws Error for another encoding or separator, and for a file of more than 64 MiB.
std::vector<std::string> csv_header(const CsvText& text);

/// Reads the columns as finite numbers: columns x records. Other columns may hold anything. Throws Error for a column
/// that is missing or there twice, a record with more or fewer cells than the header, a cell that is not a finite
/// number or wrong, a file that has not as many records as asked for, and whatever csv_header refuses.
Matrix<double> read_csv(const CsvText& text, const std::vector<CsvColumn>& columns, std::size_t records);

}  // namespace gust
