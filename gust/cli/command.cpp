#include "gust/cli/command.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <charconv>
#include <cstdlib>

#include "gust/cli/help_format.h"
#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/core/version.h"

namespace gust {
namespace {

std::string color_choice = "auto";  // NOLINT: what the user said once for the whole program

/// The command that the user meant: as deep as it was understood.
const CLI::App& deepest(const CLI::App& program) {
  const CLI::App* app = &program;
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return *app;
}

std::string full_name(const CLI::App& app) {
  const CLI::App* parent = app.get_parent();
  return parent == nullptr ? app.get_name() : full_name(*parent) + " " + app.get_name();
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* at = &app; at != nullptr; at = at->get_parent()) {
    for (const CLI::Option* option : at->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

/// What was typed and nothing takes, in our words and with the nearest name.
std::string extra_message(const CLI::App& app, const std::string& typed) {
  if (typed.starts_with('-')) {
    const std::string name = typed.substr(0, typed.find('='));
    return cat("unknown option '", name, "'", did_you_mean(name, option_names(app)));
  }
  const std::vector<std::string> names = command_names(app);
  if (!names.empty()) return cat("unknown command '", typed, "'", did_you_mean(typed, names));
  return cat("unexpected argument '", typed, "'");
}

std::string usage_message(const CLI::App& program, const CLI::ParseError& error) {
  const CLI::App& app = deepest(program);
  const std::string help = cat(" (", full_name(app), " --help)");
  const std::vector<std::string> extras = program.remaining(/*recurse=*/true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !extras.empty()) {
    return extra_message(app, extras.front()) + help;
  }
  const std::vector<std::string> names = command_names(app);
  if (!names.empty() && !extras.empty()) return extra_message(app, extras.front()) + help;
  const bool lacks_command = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  if (!names.empty() && lacks_command) return cat("which command? ", join(names, ", "), help);
  std::string message = error.what();
  if (const std::size_t end = message.find('\n'); end != std::string::npos) message.resize(end);
  return message + help;
}

/// Commands are listed under one heading. A list option takes one value each time it is named: what follows may be the
/// next argument.
void finish(CLI::App& app) {
  if (app.get_parent() != nullptr) app.group("Commands");
  for (CLI::Option* option : app.get_options()) {
    if (!option->get_positional()) option->allow_extra_args(false);
  }
  for (CLI::App* command : app.get_subcommands({})) finish(*command);
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

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

const CLI::App& find_command(const CLI::App& program, const std::vector<std::string>& names) {
  const CLI::App* app = &program;
  for (const std::string& name : names) {
    const auto inner = app->get_subcommands([&](const CLI::App* command) { return command->check_name(name); });
    if (inner.empty()) {
      throw Error(
          cat("unknown command '", name, "'", did_you_mean(name, command_names(*app)), " (gust list commands)"));
    }
    app = inner.front();
  }
  return *app;
}

CLI::Validator whole_number(const Range& range) {
  const auto check = [range](const std::string& text) {
    std::int64_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [read, failure] = std::from_chars(text.data(), end, number);
    if (failure == std::errc{} && read == end && range.contains(static_cast<double>(number))) {
      return std::string();
    }
    const std::string bounds = range.text();
    return cat("must be a whole number", bounds.empty() ? "" : ", ", bounds, ", got '", text, "'");
  };
  return {check, ""};
}

bool use_color(int file_descriptor) {
  if (color_choice != "auto") return color_choice == "always";
  return std::getenv("NO_COLOR") == nullptr && isatty(file_descriptor) != 0;
}

std::size_t terminal_columns(int file_descriptor, std::size_t standard) {
  winsize size{};
  const bool known = ioctl(file_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : standard;
}

int run_command_line(int argc, const char* const* argv) {
  CLI::App app("Says how robust a controller is, to what, and by how much.", "gust");
  app.formatter(std::make_shared<HelpFormat>());
  app.require_subcommand(1);
  app.set_version_flag(
      "--version", [] { return cat("gust ", kVersion); }, "print the version");
  app.fallthrough();
  app.add_option("--color", color_choice, "colour the output: auto, always or never")
      ->type_name("WORD")
      ->check(CLI::IsMember({"auto", "always", "never"}));
  int exit_code = kDone;
  for (const RegisterCommand command : commands()) command(app, exit_code);
  finish(app);
  // Last, for commands inherit what is there when they are made.
  app.set_help_all_flag("--help-all", "help of all commands");
  app.footer(
      "Example:\n  gust eval lqr --plant cartpole --site action --waveform step --level 5\n"
      "gust help COMMAND says more; gust list shows what there is.\n"
      "Exit codes: 0 done, 1 a trial failed or is missing, 2 wrong input, 3 a claim or check failed, 75 and 130 "
      "stopped.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);  // help and version
  } catch (const CLI::ParseError& error) {
    throw Error(usage_message(app, error));
  }
  return exit_code;
}

}  // namespace gust
