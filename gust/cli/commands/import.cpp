#include "gust/cli/command.h"
#include "gust/cli/output_file.h"
#include "gust/cli/study_command.h"
#include "gust/store/files.h"
#include "gust/study/summary/row_table.h"
#include "gust/study/text/warnings.h"

namespace gust {
namespace {

struct Options {
  std::string study, rows, out;
  std::vector<std::string> settings;
  bool json = false;
};

constexpr std::size_t kRowsBytes = std::size_t{4} << 30;

int import_rows(const Options& options) {
  Study study = StudyFolder::read(options.study, options.settings);
  for (const std::string& warning : study_warnings(study)) tell(cat("warning: ", warning));
  const StudyFolder folder(options.out.empty() ? standard_folder(study) : options.out);
  const std::string rows = read_file(options.rows, kRowsBytes);
  read_row_table(rows, options.rows, study);  // what is wrong with it is told before anything is written
  std::error_code unknown;
  if (std::filesystem::exists(folder.report(), unknown)) check_output(folder.report(), OutputKind::page, "--out");
  folder.keep(study, {options.study, options.settings, options.rows}, rows);

  const OpenStudy open(folder.path().string());
  const std::size_t threads = thread_count(0);
  const Summary summary = summarise(*open.measured, threads);
  const std::vector<PolicyPair> pairs = shown_pairs(open.study, compared_start(open.study));
  const std::string report =
      write_report(open.folder, open.study, summary, {}, compare_pairs(*open.measured, pairs, threads));
  std::string answer = options.json ? summary_json(open.study, summary) + "\n" : summary_text(open.study, summary);
  if (!options.json) answer += cat("Page: ", report, "\n");
  print_lines(answer);
  return tell_missing(summary);
}

}  // namespace

void command_import(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("import", "Takes rows that were measured elsewhere: margins, verdicts and the page of them");
  command->add_option("STUDY", options->study, "what was measured, a TOML file")->required();
  command->add_option("ROWS", options->rows, "a CSV file: a row an episode and metric, as 'gust export' writes it")
      ->required();
  command->add_option("--out", options->out, "result folder (default: ./NAME.gust)")->type_name("DIR");
  command->add_option("--set", options->settings, "replace a value of the study: key=value")->type_name("KEY=VALUE");
  command->add_flag("--json", options->json, "margins and verdicts as one JSON object");
  command->footer(
      "Example:\n  gust import studies/demo.toml rows.csv --out rig.gust\n\n"
      "Needed are the columns policy, metric and value; sweep, level, level_2, seed, start and episode where the study "
      "has more than one. Other columns of 'gust export' must say what the study says. With levels = \"auto\" a sweep "
      "has the levels of the rows.");
  command->callback([options, &exit_code] { exit_code = import_rows(*options); });
}

}  // namespace gust
