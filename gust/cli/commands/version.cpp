#include "gust/core/version.h"

#include <fmt/format.h>

#include "gust/cli/command.h"

namespace gust {

void command_version(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand("version", "Prints the version");
  command->footer("Example:\n  gust version");
  command->callback([] { fmt::print("gust {}\n", kVersion); });
}

}  // namespace gust
