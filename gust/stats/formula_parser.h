#pragma once

#include "gust/stats/formula.h"

namespace gust {

/// "study.toml:3:9: claim 'a > b', column 5: ", followed by the parts.
template <class... Parts>
Error formula_error(const Place& place, std::string_view text, std::size_t column, const Parts&... parts) {
  return error_at(place, "claim '", text, "', column ", column, ": ", parts...);
}

/// The tree of a formula's text; throws Error.
Formula::Node parse_formula(std::string_view text, const Place& place);

}  // namespace gust
