#include "gust/cli/command.h"
#include "gust/cli/reproduction_command.h"
#include "gust/cli/study_command.h"

namespace gust {
namespace {

/// Of a reproduction, from its tables. Tells which trials they lack and gives the exit code.
int report_reproduction(const std::filesystem::path& folder) {
  const PaperResults results = read_results(folder);
  print_lines(cat(write_reproduction(results, folder), "\n"));
  for (const std::string& line : results.failures) tell(line);
  if (results.missing > 0) tell(results.label());
  return results.failures.empty() && results.missing == 0 ? kDone : kTrialFailed;
}

}  // namespace

void command_report(CLI::App& app, int& exit_code) {
  auto folder = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("report", "Writes the page of a study or of a reproduction");
  command->add_option("DIR", *folder, "the folder that gust run or gust reproduce left")->required();
  command->footer("Example:\n  gust report demo.gust");
  command->callback([folder, &exit_code] {
    if (holds_results(*folder)) {
      exit_code = report_reproduction(*folder);
      return;
    }
    const OpenStudy open = open_study(*folder);
    const std::size_t threads = thread_count(0);
    const Summary summary = summarise(open.study, open.plan, *open.store, threads);
    const std::vector<PolicyPair> pairs = shown_pairs(open.study, compared_start(open.study));
    const auto compared = compare_pairs(open.study, open.plan, *open.store, pairs, threads);
    print_lines(cat(write_report(open.folder, open.study, summary, {}, compared), "\n"));
    exit_code = tell_missing(summary);
  });
}

}  // namespace gust
