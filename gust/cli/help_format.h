#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>

namespace gust {

/// How many columns texts on stdout may take: those of the terminal, at most 100 and at least 40; 80 of a file.
std::size_t text_columns();

/// An example of a command line, broken before options with the shell's "\\" where it is wider than `width` columns.
std::string wrapped_command(std::string_view line, std::size_t width);

/// A line "  name   what it is" in lines of at most `width` columns: what it is stays in its column, or stands below
/// the name where that column is too narrow.
std::string wrapped_item(std::string_view line, std::size_t width);

/// How help looks: text and examples that are wrapped to the terminal.
class HelpFormat final : public CLI::Formatter {
 public:
  HelpFormat();
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace gust
