#pragma once

#include <string_view>

#include "gust/core/value.h"

namespace gust {

/// Reads TOML into a table whose keys keep the order of the text; every value and table knows its line and column.
///
/// Throws Error "name:line:column: …" for whatever is no TOML: bad syntax or UTF-8, a key defined twice. Dates, more
/// than a mebibyte, and nesting that no study needs are errors too, so hostile bytes cost little time and memory.
Table parse_toml(std::string_view bytes, std::string_view name);

}  // namespace gust
