#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gust/study/text/study.h"

namespace gust {

/// Where along a sweep a row was measured: a level, or both values of a grid.
struct RowLevel {
  double value = 0;
  std::optional<double> second = {};
  auto operator<=>(const RowLevel&) const = default;
};
std::string text_of(const RowLevel& level);

/// Which policy and which sweep.
struct RowKey {
  std::size_t policy, sweep;
  auto operator<=>(const RowKey&) const = default;
};

/// One number of an episode.
struct TableRow {
  std::size_t line;  ///< of the table
  std::size_t start, metric;
  std::uint64_t episode;
  double value;
};

using MemberLevels = std::map<RowLevel, std::vector<TableRow>>;  ///< of one member of a policy
using GroupRows = std::map<std::size_t, MemberLevels>;           ///< by member

/// Reads the lines of a table (row_table.h) and sorts them. Throws Error with the line where one is not the study's.
std::map<RowKey, GroupRows> read_table_rows(std::string_view text, std::string_view name, const Study& study);

}  // namespace gust
