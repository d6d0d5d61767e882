#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gust {

/// The candidate nearest to what was typed, or an empty text when none is near enough to be meant.
std::string nearest(std::string_view typed, std::span<const std::string> candidates);

/// "; did you mean 'x'?" for the nearest candidate, else an empty text.
std::string did_you_mean(std::string_view typed, std::span<const std::string> candidates);

/// The parts with a separator between them.
std::string join(std::span<const std::string> parts, std::string_view separator);

/// The parts of a text between separators; an empty text has no parts.
std::vector<std::string> split_text(std::string_view text, char separator);

/// The text of a file in UTF-8, without the byte order mark that some programs put first. Throws Error, which begins
/// with the name, where the bytes are UTF-16 or UTF-32.
std::string_view utf8_text(std::string_view bytes, std::string_view name);

/// The text's letters and digits as a part of a file's name, "action-step", of at most so many characters.
std::string slug(std::string_view text, std::size_t most = 100);

/// How many columns of a terminal a UTF-8 text takes, one a code point.
std::size_t text_width(std::string_view text);

/// Breaks lines at spaces so that none is wider than `width` columns; before further lines of a broken one stand
/// `indent` spaces, which are not counted. A word that is wider stays whole. Lines that begin with a space, such as
/// examples, stay as they are.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent = 0);

/// The text as one word of a POSIX shell, quoted where it must be.
std::string shell_word(const std::string& text);

}  // namespace gust
