#pragma once

#include <CLI/CLI.hpp>
#include <string>

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

/// Whether text on this file descriptor may be coloured: a terminal, NO_COLOR unset, and not switched off by --color.
bool use_color(int file_descriptor);

}  // namespace gust
