#include "gust/cli/help_format.h"

#include <fmt/format.h>

#include <algorithm>

namespace gust {
namespace {

constexpr std::size_t kWidth = 100;
constexpr std::size_t kNames = 28;  // columns for the names of options and commands

void append_wrapped(std::string& to, std::string_view line, std::size_t width, std::size_t indent) {
  const bool as_it_is = line.starts_with(' ');
  while (!as_it_is && line.size() > width) {
    std::size_t end = line.rfind(' ', width);
    if (end == std::string_view::npos) end = line.find(' ');
    if (end == std::string_view::npos) break;
    to.append(line.substr(0, end)).append("\n").append(indent, ' ');
    line.remove_prefix(end + 1);
  }
  to.append(line);
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string to;
  while (true) {
    const std::size_t end = text.find('\n');
    append_wrapped(to, text.substr(0, end), width, indent);
    if (end == std::string_view::npos) return to;
    to += '\n';
    text.remove_prefix(end + 1);
  }
}

HelpFormat::HelpFormat() {
  column_width(kNames);
  label("TEXT", "");
  label("REQUIRED", "(required)");
  label("SUBCOMMAND", "COMMAND");
}

std::string HelpFormat::make_description(const CLI::App* app) const {
  return wrapped(app->get_description(), kWidth) + "\n\n";
}

std::string HelpFormat::make_footer(const CLI::App* app) const {
  return app->get_footer().empty() ? std::string() : wrapped(app->get_footer(), kWidth) + "\n";
}

std::string HelpFormat::make_subcommand(const CLI::App* command) const {
  std::string first = command->get_description();
  first.resize(std::min(first.find('\n'), first.size()));
  if (first.ends_with('.')) first.pop_back();
  return fmt::format("  {:<{}}{}\n", command->get_name(), kNames - 2, first);
}

std::string HelpFormat::make_option_desc(const CLI::Option* option) const {
  return wrapped(option->get_description(), kWidth - kNames);  // CLI11 indents each line
}

}  // namespace gust
