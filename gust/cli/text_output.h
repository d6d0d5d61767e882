#pragma once

#include <string>
#include <string_view>

namespace gust {

/// The text with control characters, which could steer a terminal, told as "\\x1b"; those in `kept` stay.
std::string printable(std::string_view text, std::string_view kept = "");

/// Tells one line on stderr. Nobody may be listening: what cannot be written is lost.
void tell(std::string_view text);

/// Prints lines on stdout. Names in them may come from files of others; see printable().
void print_lines(std::string_view text);

/// Sees to it that no file which is opened later takes the place of a closed stdin, stdout or stderr.
void hold_standard_files();

}  // namespace gust
