#include "gust/cli/command.h"
#include "gust/cli/output_file.h"
#include "gust/cli/reproduction_command.h"
#include "gust/cli/study_command.h"

namespace gust {
namespace {

struct Options {
  std::string folder;
  std::string out;  ///< empty: the folder itself
};

/// Of a reproduction, from its tables. Tells which trials they lack and gives the exit code.
int report_reproduction(const Options& options) {
  const PaperResults results = read_results(options.folder);
  if (!options.out.empty()) make_output_folder(options.out, "--out");
  print_lines(cat(write_reproduction(results, options.out.empty() ? options.folder : options.out), "\n"));
  for (const std::string& line : results.failures) tell(line);
  if (results.missing > 0) tell(results.label());
  return results.failures.empty() && results.missing == 0 ? kDone : kTrialFailed;
}

int report_study(const OpenStudy& open, const std::filesystem::path& into) {
  const std::size_t threads = thread_count(0);
  const Summary summary = summarise(*open.measured, threads);
  const std::vector<PolicyPair> pairs = shown_pairs(open.study, compared_start(open.study));
  const auto compared = compare_pairs(*open.measured, pairs, threads);
  if (!into.empty()) make_output_folder(into, "--out");
  print_lines(cat(write_report(open.folder, open.study, summary, {}, compared, into), "\n"));
  return tell_missing(summary);
}

}  // namespace

void command_report(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("report", "Writes the page of a study or of a reproduction");
  command->add_option("DIR", options->folder, "the folder that gust run or gust reproduce left")->required();
  command->add_option("--out", options->out, "where to write the page (default: DIR, which is else left as it is)")
      ->type_name("FOLDER");
  command->footer("Examples:\n  gust report demo.gust\n  gust report demo.gust --out page");
  command->callback([options, &exit_code] {
    if (holds_results(options->folder)) {
      exit_code = report_reproduction(*options);
      return;
    }
    const OpenStudy open(options->folder);
    exit_code = report_study(open, options->out);
  });
}

}  // namespace gust
