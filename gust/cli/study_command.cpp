#include "gust/cli/study_command.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "gust/cli/command.h"
#include "gust/cli/output_file.h"
#include "gust/cli/progress_text.h"
#include "gust/core/text.h"
#include "gust/core/version.h"
#include "gust/store/files.h"
#include "gust/study/summary/row_table.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string machine() {
  utsname system{};
  if (uname(&system) != 0) return "unknown";
  return cat(system.sysname, " ", system.machine, ", ", std::thread::hardware_concurrency(), " cores");
}

std::string now_text() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  char text[64];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
  return text;
}

Json margin_json(const Study& study, const Summary& summary, const Series& series) {
  const Sweep& sweep = study.sweeps[series.sweep];
  return {{"policy", study.policies[series.policy].name},
          {"sweep", sweep.name},
          {"site", site_name(sweep.injection->site)},
          {"waveform", sweep.injection->kind()},
          {"start", study.starts[series.start].name},
          {"undisturbed", number(summary.undisturbed(series.policy, series.start))},
          {"margin", number(series.margin.level.estimate)},
          {"low", number(series.margin.level.low)},
          {"high", number(series.margin.level.high)},
          {"censored", series.margin.censored},
          {"at_most", series.margin.at_most},
          {"reason", series.margin.reason},
          {"last_level", number(series.margin.last_level)},
          {"unit", unit_name(series.margin.level.unit)},
          {"n", series.margin.level.n}};
}

/// The command that a page names: the run that left the folder.
std::string run_command(const StudyFolder& folder, const Study& study) {
  const RunInputs inputs = folder.inputs();
  std::string command = inputs.rows.empty()
                            ? cat("gust run ", shell_word(inputs.study))
                            : cat("gust import ", shell_word(inputs.study), " ", shell_word(inputs.rows));
  for (const std::string& setting : inputs.settings) command += cat(" --set ", shell_word(setting));
  const std::string path = folder.path().string();
  return path == standard_folder(study) ? command : cat(command, " --out ", shell_word(path));
}

}  // namespace

OpenStudy::OpenStudy(const std::string& path)
    : folder(std::filesystem::path(path)), study(folder.open(tell)), imported(!folder.inputs().rows.empty()) {
  if (imported) {
    measured = read_row_table(folder.read_rows(), folder.rows().string(), study);
    return;
  }
  store = std::make_unique<Store>(folder.store(), Store::Access::read, tell);
  plan = plan_with_store(study, *store);
  measured = stored_measurements(study, plan, *store);
}

const Store& OpenStudy::trials(std::string_view command) const {
  if (store) return *store;
  throw Error(cat(folder.path().string(),
                  ": its rows were measured elsewhere (rows.csv), so there is nothing for 'gust ", command, "'"));
}

int tell_missing(const Summary& summary) {
  for (const std::string& note : summary.notes) tell(cat("warning: ", note));
  for (const std::string& missing : summary.missing) tell(cat("not in the store: ", missing));
  return summary.missing.empty() ? kDone : kTrialFailed;
}

void tell_plan(const Plan& plan, const Store& store, std::size_t threads) {
  std::size_t missing = 0;
  double seconds = 0, longest = 0;
  for (const Trial& trial : plan.trials) {
    if (store.has(kind_name(trial.kind), trial.id)) continue;
    ++missing;
    seconds += trial.seconds;
    longest = std::max(longest, trial.seconds);
  }
  const double together = std::max(longest, seconds / static_cast<double>(threads));
  if (isatty(STDERR_FILENO) != 0 || together < kWorthTelling) return;
  tell(cat(missing, " trials to run, about ", clock_text(together), " on ", threads,
           threads == 1 ? " thread" : " threads"));
}

std::size_t thread_count(std::size_t asked) {
  if (asked > 0) return asked;
  if (const char* variable = std::getenv("GUST_THREADS"); variable != nullptr && *variable != '\0') {
    const Value value = value_from_text(variable, {"GUST_THREADS"});
    const std::int64_t threads = value.as_int("threads");
    if (threads < 1 || threads > 1024) throw error_at(value.place, "must be 1 to 1024, got ", threads);
    return static_cast<std::size_t>(threads);
  }
  return std::max(1u, std::thread::hardware_concurrency());
}

std::string complaint(const Trial& trial, const Outcome& outcome) {
  return cat(trial.what, outcome.state == Outcome::State::skipped ? " was skipped: " : " failed: ", outcome.reason);
}

std::vector<std::string> complaints(std::span<const RunOutcome> outcomes) {
  struct Complaint {
    std::string line;
    std::set<std::string> skipped;  // trials that it took with it
  };
  std::vector<std::string> order;  // of ids: studies share trials, under names of their own
  std::map<std::string, Complaint> by_trial;
  for (const RunOutcome& outcome : outcomes) {
    const auto complaint_of = [&](std::size_t trial) -> Complaint& {
      const auto [at, is_new] = by_trial.try_emplace(outcome.plan.trials[trial].id);
      if (!is_new) return at->second;
      order.push_back(at->first);
      at->second.line = complaint(outcome.plan.trials[trial], outcome.outcomes[trial]);
      return at->second;
    };
    for (std::size_t i = 0; i < outcome.outcomes.size(); ++i) {
      const Trial& trial = outcome.plan.trials[i];
      if (outcome.outcomes[i].state == Outcome::State::failed) complaint_of(i);
      if (outcome.outcomes[i].state != Outcome::State::skipped) continue;
      const std::size_t cause = trial.inputs.empty() ? i : trial.inputs.front();
      const bool known = outcome.outcomes[cause].state == Outcome::State::failed;
      if (known)
        complaint_of(cause).skipped.insert(trial.id);
      else
        complaint_of(i);
    }
  }
  std::vector<std::string> lines;
  for (const std::string& id : order) {
    const auto& [line, skipped] = by_trial.at(id);
    const char* trials = skipped.size() == 1 ? " trial" : " trials";
    lines.push_back(skipped.empty() ? line : cat(line, "; ", skipped.size(), trials, " of it skipped"));
  }
  return lines;
}

std::vector<std::pair<std::string, std::string>> provenance() {
  return {{"gust", std::string(kVersion)}, {"machine", machine()}, {"made", now_text()}};
}

std::string write_report(const StudyFolder& folder, const Study& study, const Summary& summary,
                         const std::vector<std::string>& warnings, std::vector<SweepComparison> comparisons,
                         const std::filesystem::path& into) {
  PageContext context;
  context.comparisons = std::move(comparisons);
  context.run_command = run_command(folder, study);
  context.folder = folder.path().string();
  const std::string rows = folder.inputs().rows;
  context.export_command =
      rows.empty() ? cat("gust export ", shell_word(folder.path().string()), " --csv ", shell_word(study.name + ".csv"))
                   : "";
  context.warnings = warnings;
  context.provenance = {{"gust", std::string(kVersion)},
                        {"plant", study.setup.plant.canonical()},
                        {"readings", study.setup.preset.empty() ? "none" : study.setup.readings_text()},
                        {"root seed", cat(study.seed)},
                        {"machine", machine()},
                        {"made", now_text()}};
  if (const std::string missing = study.metric_set.not_applicable(); !missing.empty())
    context.provenance.emplace_back("metrics not applicable", missing);
  if (!rows.empty()) context.provenance.push_back({"rows", cat("measured elsewhere: ", rows)});
  const std::filesystem::path page = into.empty() ? folder.report() : into / folder.report().filename();
  check_output(page, OutputKind::page, "page");
  write_file_atomically(page, render_page(study_page(study, summary, context)));
  return page.string();
}

std::string summary_text(const Study& study, const Summary& summary) {
  std::string text;
  const std::size_t columns = terminal_columns(STDOUT_FILENO, kUsualColumns);
  const std::string metric = study.metric_set.name(summary.margin_metric);
  for (const std::size_t start : starts_to_tell(study)) {
    const std::string table = margins_table(study, summary, start, columns);
    if (table.empty()) continue;
    const std::string head = cat("Robustness margins, ", study.starts[start].name, " start: level where ", metric,
                                 " falls to 90 % of undisturbed");
    text += cat(wrapped(head, columns), "\n\n", table, "\n");
  }
  if (text.empty()) text = "No margins: nothing grows level by level. The page shows what was measured.\n\n";
  if (!summary.claims.empty()) text += cat("Claims\n\n", claims_table(summary, columns), "\n");
  return text;
}

std::string summary_json(const Study& study, const Summary& summary) {
  Json margins = Json::array();
  for (const Series& series : summary.series) {
    if (series.has_margin) margins.push_back(margin_json(study, summary, series));
  }
  Json claims = Json::array();
  for (const ClaimVerdict& verdict : summary.claims) {
    claims.push_back({{"id", verdict.claim->id},
                      {"text", verdict.claim->text},
                      {"holds", verdict.claim->holds},
                      {"verdict", ruling_name(verdict.finding.verdict.ruling)},
                      {"reason", verdict.finding.verdict.reason},
                      {"needed", verdict.finding.verdict.needed},
                      {"estimate", number(verdict.finding.measured.estimate)},
                      {"low", number(verdict.finding.measured.low)},
                      {"high", number(verdict.finding.measured.high)},
                      {"unit", unit_name(verdict.finding.measured.unit)},
                      {"n", verdict.finding.measured.n}});
  }
  return Json{{"study", study.name},    {"metric", study.metric_set.name(summary.margin_metric)},
              {"margins", margins},     {"claims", claims},
              {"notes", summary.notes}, {"missing", summary.missing}}
      .dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace gust
