#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gust/core/value.h"
#include "gust/paper/paper.h"

namespace gust {

// What parse_paper asks of names. Each throws Error at the place of the value.

/// A value is one of the names.
void check_known(const std::vector<std::string>& known, const Value& value, const char* what);

/// A value is the study of a figure.
void check_study(const Paper& paper, const Value& value);
/// So is every text of a list, if the table has it.
void check_studies(const Paper& paper, const Table& table, std::string_view key);

/// A key, if the table has it, names a reading.
void check_reading(const Paper& paper, const Table& table, std::string_view key);

/// A value can be the name of a file or folder among the results.
void check_file_name(const Value& value, std::string_view key);

/// The results of a reading have a folder of their own.
void check_folder_name(const Paper& paper, const PaperReading& reading, const Place& place);

}  // namespace gust
