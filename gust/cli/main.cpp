#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>

#include "gust/cli/command.h"
#include "gust/core/error.h"
#include "gust/core/text.h"

namespace gust {
namespace {

std::string color_choice = "auto";  // NOLINT: what the user said once for the whole program

/// CLI11 says what is wrong; a misspelt command or option deserves the nearest one too.
std::string hint_for(const CLI::App& app, const std::string& typed) {
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  if (!app.get_subcommands().empty()) {
    known.clear();
    for (const CLI::Option* option : app.get_subcommands().front()->get_options()) {
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    }
  }
  return did_you_mean(typed, known);
}

int usage_error(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  if (error.get_exit_code() == 0) return app.exit(error);  // help and version
  std::string hint;
  for (int i = 1; i < argc && hint.empty(); ++i) {
    const std::string typed = argv[i];
    const std::string message = error.what();
    if (message.find(typed.substr(0, typed.find('='))) != std::string::npos) hint = hint_for(app, typed);
  }
  fmt::print(stderr, "gust: {}{} (gust help)\n", error.what(), hint);
  return kUsage;
}

int run(int argc, char** argv) {
  CLI::App app("Says how robust a controller is, to what, and by how much.", "gust");
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "help of all commands");
  app.fallthrough();
  app.add_option("--color", color_choice, "colour the output: auto, always or never")
      ->check(CLI::IsMember({"auto", "always", "never"}));
  int exit_code = kDone;
  for (const RegisterCommand command : commands()) command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return usage_error(app, error, argc, argv);
  }
  return exit_code;
}

}  // namespace

#define GUST_ENTRY(name) void command_##name(CLI::App& app, int& exit_code);
#include "gust/cli/commands/list.inc"
#undef GUST_ENTRY

std::vector<RegisterCommand> commands() {
  return {
#define GUST_ENTRY(name) command_##name,
#include "gust/cli/commands/list.inc"
#undef GUST_ENTRY
  };
}

bool use_color(int file_descriptor) {
  if (color_choice != "auto") return color_choice == "always";
  return std::getenv("NO_COLOR") == nullptr && isatty(file_descriptor) != 0;
}

}  // namespace gust

int main(int argc, char** argv) {
  try {
    return gust::run(argc, argv);
  } catch (const gust::Error& error) {
    fmt::print(stderr, "gust: {}\n", error.what());
    return gust::kUsage;
  } catch (const std::exception& bug) {
    fmt::print(stderr, "gust: internal error: {}; please report it with the command and its input\n", bug.what());
    return gust::kTrialFailed;
  }
}
