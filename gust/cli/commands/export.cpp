#include "gust/study/summary/export.h"

#include <map>
#include <set>

#include "gust/cli/command.h"
#include "gust/cli/output_file.h"
#include "gust/cli/study_command.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

constexpr const char* kFooter =
    "Example:\n  gust export demo.gust --csv demo.csv\n\n"
    "Columns: plant, preset, readings, policy, seed (or file); sweep (its name), site, channels (with factors that are "
    "not 1), waveform, window (control steps start:end) of what is swept, \"none\" where nothing is; vary (parameters "
    "along the axes, and what else the sweep sets); level and, of a grid, level_2; start, episode, metric, value. No "
    "two rows agree in all but the value.";

/// Tells which evaluations a table lacks, those of a training that failed together, and gives the exit code.
int tell_what_lacks(const OpenStudy& open, const std::set<std::size_t>& missing) {
  std::map<std::string, std::size_t> of_failed;
  for (const std::size_t i : missing) {
    const Trial& trial = open.plan.trials[i];
    const std::optional<std::string> failure = training_failure(open.plan, trial, *open.store);
    if (failure) ++of_failed[cat(open.plan.trials[trial.inputs.front()].what, " failed: ", *failure)];
    if (!failure) tell(cat("not in the store: ", trial.what));
  }
  for (const auto& [training, count] : of_failed)
    tell(cat(training, "; ", count, count == 1 ? " trial" : " trials", " of it missing"));
  if (!open.plan.complete) tell("not in the store: what needs automatic levels that were not found");
  return missing.empty() && open.plan.complete ? kDone : kTrialFailed;
}

}  // namespace

void command_export(CLI::App& app, int& exit_code) {
  struct Options {
    std::string folder, csv, sqlite;
    bool force = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("export", "Writes every episode of a study as one table");
  command->add_option("DIR", options->folder, "the folder that gust run left")->required();
  CLI::Option* csv = command->add_option("--csv", options->csv, "CSV file: a row an episode and metric, in plan order");
  CLI::Option* sqlite =
      command->add_option("--sqlite", options->sqlite, "SQLite file: the same, and the learning curves");
  command->add_flag("--force", options->force, "replace files that are no tables of gust");
  csv->type_name("FILE");
  sqlite->type_name("FILE");
  command->footer(kFooter);
  command->callback([options, &exit_code] {
    if (options->csv.empty() && options->sqlite.empty())
      throw Error("where to? give --csv FILE, --sqlite FILE, or both (gust export --help)");
    if (!options->csv.empty() && !options->sqlite.empty() && is_same_output(options->csv, options->sqlite))
      throw Error("--csv and --sqlite: name two files");
    if (!options->csv.empty()) check_output(options->csv, OutputKind::csv, "--csv", options->force);
    if (!options->sqlite.empty()) check_output(options->sqlite, OutputKind::sqlite, "--sqlite", options->force);
    const OpenStudy open(options->folder);
    const Store& trials = open.trials("export");
    std::set<std::size_t> missing;
    const auto add = [&](const std::vector<std::size_t>& trials) { missing.insert(trials.begin(), trials.end()); };
    if (!options->csv.empty()) add(export_csv(open.study, open.plan, trials, options->csv));
    if (!options->sqlite.empty()) add(export_sqlite(open.study, open.plan, trials, options->sqlite));
    exit_code = tell_what_lacks(open, missing);
  });
}

}  // namespace gust
