#include <fmt/format.h>

#include <cstdio>

#include "gust/cli/command.h"
#include "gust/core/error.h"

int main(int argc, char** argv) {
  try {
    const int exit_code = gust::run_command_line(argc, argv);
    if (std::fflush(stdout) != 0) throw gust::Error("standard output: cannot be written to");
    return exit_code;
  } catch (const gust::Error& error) {
    fmt::print(stderr, "gust: {}\n", error.what());
    return gust::kUsage;
  } catch (const std::exception& bug) {
    fmt::print(stderr, "gust: internal error: {}; please report it with the command and its input\n", bug.what());
    return gust::kTrialFailed;
  }
}
