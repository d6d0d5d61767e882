#include "gust/cli/command.h"
#include "gust/cli/environment.h"
#include "gust/cli/output_file.h"
#include "gust/cli/progress.h"
#include "gust/cli/signals.h"
#include "gust/cli/study_command.h"
#include "gust/study/text/warnings.h"

namespace gust {
namespace {

struct Options {
  std::string study, out;
  std::size_t threads = 0;
  std::vector<std::string> settings;
  bool require = false;
  bool json = false;
};

bool required_claims_hold(const Study& study, const Summary& summary) {
  std::size_t held = 0;
  std::size_t required = 0;
  for (const StudyClaim& claim : study.claims) required += claim.required ? 1 : 0;
  for (const ClaimVerdict& verdict : summary.claims) {
    held += verdict.claim->required && verdict.finding.verdict.ruling == Ruling::holds ? 1 : 0;
  }
  return held == required;
}

/// What follows the trials: the page and the answer.
int tell_results(const Options& options, const StudyFolder& folder, const Study& study, const Store& store,
                 const RunOutcome& outcome) {
  const std::size_t threads = thread_count(options.threads);
  const std::vector<std::string> warnings = complaints(std::span(&outcome, 1));
  for (const std::string& line : warnings) tell(line);
  const auto measured = stored_measurements(study, outcome.plan, store);
  const Summary summary = summarise(*measured, threads);
  for (const std::string& note : summary.notes) tell(cat("warning: ", note));
  std::string report;
  try {
    const std::vector<PolicyPair> pairs = shown_pairs(study, compared_start(study));
    report = write_report(folder, study, summary, warnings, compare_pairs(*measured, pairs, threads));
  } catch (const Error& error) {  // the disk may be full by now, which must not hide the answer
    tell(error.what());
  }
  std::string answer = options.json ? summary_json(study, summary) + "\n" : summary_text(study, summary);
  if (!options.json && !report.empty()) answer += cat("Page: ", report, "\n");
  const std::string where = cat("the results are in ", folder.path().string(), " (gust show)");
  const bool told = print_result(answer, where);
  const bool lacks = outcome.failed() > 0 || !summary.missing.empty() || store.disagreements() > 0;
  if (lacks || report.empty() || !told) return kTrialFailed;
  return options.require && !required_claims_hold(study, summary) ? kCheckFailed : kDone;
}

int run(const Options& options) {
  SignalWatch signals;
  Study study = StudyFolder::read(options.study, options.settings);
  const StudyFolder folder(options.out.empty() ? standard_folder(study) : options.out);
  for (const std::string& warning : study_warnings(study)) tell(cat("warning: ", warning));
  warn_of_plain_products();
  const std::size_t threads = thread_count(options.threads);
  std::error_code unknown;
  if (std::filesystem::exists(folder.report(), unknown)) check_output(folder.report(), OutputKind::page, "--out");
  folder.keep(study, {options.study, options.settings});
  const Store store(folder.store(), Store::Access::write, tell);
  tell_plan(plan_with_store(study, store), store, threads);

  bool worked = false;
  RunOptions how{threads, signals.token(), {}};
  how.watch = [&](Progress& progress, const std::function<void()>& work) {
    worked = true;
    show_progress(progress, work);
  };
  try {
    const RunOutcome outcome = run_study(study, store, how);
    worked = true;
    if (!outcome.stopped) return tell_results(options, folder, study, store, outcome);
    for (const std::string& line : complaints(std::span(&outcome, 1))) tell(line);
  } catch (const std::exception& error) {
    if (!worked) throw;
    tell(error.what());
    tell(cat("what was finished is safe in ", folder.path().string(), "; the same command goes on from there"));
    return kTrialFailed;
  }
  tell("stopped; the same command goes on from here");
  return signals.exit_code();
}

}  // namespace

void command_run(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("run", "Runs a study, or goes on with it, and writes its page");
  command->add_option("STUDY", options->study, "the study, a TOML file")->required();
  command->add_option("--out", options->out, "result folder (default: ./NAME.gust)")->type_name("DIR");
  command->add_option("--threads", options->threads, "trials at a time (default: GUST_THREADS, else all cores)")
      ->check(whole_number(between(1, 1024)))
      ->type_name("N");
  command->add_option("--set", options->settings, "replace a value of the study: key=value")->type_name("KEY=VALUE");
  command->add_flag("--require", options->require, "exit with 3 if a required claim does not hold");
  command->add_flag("--json", options->json, "margins and verdicts as one JSON object");
  command->footer("Example:\n  gust run studies/demo.toml --threads 2 --set evaluate.episodes=10");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace gust
