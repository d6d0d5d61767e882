#include "gust/cli/completion.h"

#include <fmt/format.h>

#include "gust/cli/command.h"

namespace gust {

void command_completion(CLI::App& app, int&) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("completion", "Prints a script that lets a shell complete what is typed");
  command->add_option("SHELL", *shell, "bash, zsh or fish")->required();
  command->footer("Example:\n  source <(gust completion bash)");
  command->callback([&app, shell] { fmt::print("{}", completion_script(app, *shell)); });
}

}  // namespace gust
