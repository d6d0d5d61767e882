#include <fmt/format.h>

#include "gust/cli/command.h"
#include "gust/core/error.h"
#include "gust/core/text.h"

namespace gust {

void command_help(CLI::App& app, int&) {
  auto names = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("help", "Explains the program or a command");
  command->add_option("COMMAND", *names, "such as run, or store pack")->type_name("");
  command->footer("Example:\n  gust help eval");
  command->callback([&app, names] {
    const CLI::App& about = find_command(app, *names);
    const std::string path = join(*names, " ");
    // not about.help(): it would explain the command that is running, which is help
    fmt::print("{}", app.get_formatter()->make_help(&about, cat("gust", path.empty() ? "" : " ", path),
                                                    CLI::AppFormatMode::Normal));
  });
}

}  // namespace gust
