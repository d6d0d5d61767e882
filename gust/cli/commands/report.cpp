#include <fmt/format.h>

#include "gust/cli/command.h"
#include "gust/cli/reproduction_command.h"
#include "gust/cli/study_command.h"

namespace gust {

void command_report(CLI::App& app, int& exit_code) {
  auto folder = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("report", "Writes the page of a study or of a reproduction");
  command->add_option("DIR", *folder, "the folder that gust run or gust reproduce left")->required();
  command->footer("Example:\n  gust report demo.gust");
  command->callback([folder, &exit_code] {
    if (holds_results(*folder)) {
      fmt::print("{}\n", write_reproduction(read_results(*folder), *folder));
      return;
    }
    const OpenStudy open = open_study(*folder);
    const Summary summary = summarise(open.study, open.plan, *open.store, thread_count(0));
    fmt::print("{}\n", write_report(open.folder, open.study, summary, {}));
    if (!summary.missing.empty()) exit_code = kTrialFailed;
  });
}

}  // namespace gust
