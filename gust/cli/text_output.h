#pragma once

#include <string>
#include <string_view>

namespace gust {

/// The text with control characters, which could steer a terminal, told as "\\x1b"; those in `kept` stay.
std::string printable(std::string_view text, std::string_view kept = "");

/// A message in which nothing quoted and no word is longer than 200 characters: what follows is left out.
std::string shortened(std::string_view message);

/// Tells one line on stderr, shortened. Nobody may be listening: what cannot be written is lost.
void tell(std::string_view text);

/// Prints lines on stdout. Names in them may come from files of others; see printable().
void print_lines(std::string_view text);

/// The same of an answer that has been written elsewhere too; if nobody takes it, tells where ("the results are in …")
/// and gives false.
bool print_result(std::string_view text, std::string_view where);

/// Sees to it that no file which is opened later takes the place of a closed stdin, stdout or stderr.
void hold_standard_files();

}  // namespace gust
