#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>

namespace gust {

/// Breaks lines at spaces so that none is longer than `width`; further lines of a broken one begin with `indent`
/// spaces. Lines that begin with a space, such as examples, stay as they are.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent = 0);

/// How help looks: wrapped text, and one line a command in the list of commands.
class HelpFormat final : public CLI::Formatter {
 public:
  HelpFormat();
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace gust
