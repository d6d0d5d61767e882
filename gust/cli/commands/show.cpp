#include "gust/cli/command.h"
#include "gust/cli/study_command.h"

namespace gust {

void command_show(CLI::App& app, int& exit_code) {
  struct Options {
    std::string folder;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("show", "Prints the margins and verdicts of a finished study");
  command->add_option("DIR", options->folder, "the folder that gust run left")->required();
  command->add_flag("--json", options->json, "as one JSON object");
  command->footer("Example:\n  gust show demo.gust");
  command->callback([options, &exit_code] {
    const OpenStudy open(options->folder);
    const Summary summary = summarise(*open.measured, thread_count(0));
    print_lines(cat(options->json ? summary_json(open.study, summary) : summary_text(open.study, summary), "\n"));
    exit_code = tell_missing(summary);
  });
}

}  // namespace gust
