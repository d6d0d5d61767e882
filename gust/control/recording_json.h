#pragma once

#include "gust/core/value.h"

namespace gust {

/// Reads a JSON object, every value with its place in the text. A key that is null counts as absent. Throws Error for
/// what is not JSON, not an object, too long (256 KiB), too deep (8), or has a key twice.
Table read_json_table(std::string_view bytes, const std::string& name);

}  // namespace gust
