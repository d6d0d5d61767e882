#include "gust/cli/help_format.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "gust/cli/command.h"
#include "gust/core/text.h"

namespace gust {
namespace {

constexpr std::size_t kNames = 28;  // columns for the names of options and commands

/// Columns of help: --help-all indents that of each command.
std::size_t help_columns() { return text_columns() - 2; }

/// A text whose lines are wrapped, those of examples as command lines, those of "  name   what it is" below the latter.
std::string help_text(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with("  "))
      lines.push_back(wrapped(line, help_columns()));
    else if (line.find("  ", 2) != line.npos)
      lines.push_back(wrapped_item(line, help_columns()));
    else
      lines.push_back(wrapped_command(line, help_columns()));
  }
  return join(lines, "\n");
}

}  // namespace

std::size_t text_columns() {
  constexpr std::size_t kMost = 100;  // longer lines read badly
  constexpr std::size_t kLeast = 40;
  return std::clamp(terminal_columns(STDOUT_FILENO, kUsualColumns), kLeast, kMost);
}

std::string wrapped_command(std::string_view line, std::size_t width) {
  constexpr std::string_view kOption = " --";
  constexpr std::string_view kBreak = " \\\n     ";
  std::string to;
  std::size_t room = width;
  while (text_width(line) > room) {
    const std::size_t least = room - std::min(room, std::size_t{2});  // " \\" takes two columns
    std::size_t end = line.rfind(kOption, least);
    if (end == line.npos || end == 0) end = line.find(kOption, 1);
    if (end == line.npos) break;
    to.append(line.substr(0, end)).append(kBreak);
    line.remove_prefix(end);
    room = width - 5;
  }
  return to.append(line);
}

std::string wrapped_item(std::string_view line, std::size_t width) {
  constexpr std::size_t kLeast = 30;  // columns that are worth a column of their own
  constexpr std::size_t kIndent = 6;
  const std::size_t name_end = line.find("  ", line.find_first_not_of(' '));
  const std::size_t begin = line.find_first_not_of(' ', name_end);
  if (text_width(line) <= width || name_end == line.npos || begin == line.npos) return std::string(line);
  const std::size_t column = text_width(line.substr(0, begin));
  const std::string_view what = line.substr(begin);
  if (column + kLeast <= width) return cat(line.substr(0, begin), wrapped(what, width - column, column));
  return cat(line.substr(0, name_end), "\n", std::string(kIndent, ' '),
             wrapped(what, width - std::min(width - 1, kIndent), kIndent));
}

HelpFormat::HelpFormat() {
  column_width(kNames);
  label("TEXT", "");
  label("REQUIRED", "(required)");
  label("SUBCOMMAND", "COMMAND");
}

std::string HelpFormat::make_description(const CLI::App* app) const {
  return help_text(app->get_description()) + "\n\n";
}

std::string HelpFormat::make_footer(const CLI::App* app) const {
  return app->get_footer().empty() ? std::string() : help_text(app->get_footer()) + "\n";
}

std::string HelpFormat::make_subcommand(const CLI::App* command) const {
  std::string first = command->get_description();
  first.resize(std::min(first.find('\n'), first.size()));
  if (first.ends_with('.')) first.pop_back();
  return fmt::format("  {:<{}}{}\n", command->get_name(), kNames - 2, wrapped(first, help_columns() - kNames, kNames));
}

std::string HelpFormat::make_option_desc(const CLI::Option* option) const {
  return wrapped(option->get_description(), help_columns() - kNames);  // CLI11 indents each line
}

}  // namespace gust
