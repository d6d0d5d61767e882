#pragma once

#include <string>
#include <string_view>

namespace gust {

/// A TOML text with the same content in lines of at most `width` columns, as far as TOML can break them: comments are
/// wrapped, and stand above a line that they make too long; long strings become multi-line ones; inline tables become
/// dotted keys.
std::string wrapped_toml(std::string_view text, std::size_t width);

}  // namespace gust
