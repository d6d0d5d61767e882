#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "gust/cli/text_output.h"
#include "gust/core/fields.h"

namespace gust {

/// Exit codes of every command.
inline constexpr int kDone = 0;
inline constexpr int kTrialFailed = 1;
inline constexpr int kUsage = 2;
inline constexpr int kCheckFailed = 3;
inline constexpr int kTerminated = 75;
inline constexpr int kInterrupted = 130;

/// Registers a subcommand: its options, its help with an example, and a callback that does the work, writes the answer
/// to stdout and everything else to stderr, and sets the exit code. Errors leave as exceptions; main() tells them.
using RegisterCommand = void (*)(CLI::App& app, int& exit_code);

/// Every command there is, in the order of commands/list.inc.
std::vector<RegisterCommand> commands();

/// The names of the commands of the whole program, or of the subcommands of one.
std::vector<std::string> command_names(const CLI::App& app);

/// The command of a name, such as "run" or "store pack"; an Error with the nearest name if there is none.
const CLI::App& find_command(const CLI::App& program, const std::vector<std::string>& names);

/// Runs the command line and gives the exit code. A command line that cannot be read is an Error.
int run_command_line(int argc, const char* const* argv);

/// Accepts a whole number within bounds.
CLI::Validator whole_number(const Range& range = anything);

/// Whether text on this file descriptor may be coloured: a terminal, NO_COLOR unset, and not switched off by --color.
bool use_color(int file_descriptor);

inline constexpr std::size_t kUsualColumns = 80;  ///< where there is no terminal

/// How many columns the terminal on this file descriptor has; the standard where there is no terminal.
std::size_t terminal_columns(int file_descriptor, std::size_t standard);

}  // namespace gust
