#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "gust/cli/command.h"
#include "gust/cli/progress.h"
#include "gust/cli/progress_text.h"
#include "gust/cli/reproduction_command.h"
#include "gust/cli/signals.h"
#include "gust/cli/study_command.h"
#include "gust/core/text.h"
#include "gust/report/reproduction_results.h"
#include "gust/study/files.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string paper, out;
  ReproductionChoice choice;
  std::size_t threads = 0;
  bool so_far = false;
  bool json = false;
};

struct Run {
  std::vector<RunOutcome> outcomes;  ///< of the studies
  int stopped = kDone;               ///< the exit code if it was
};

/// Only what the store holds already, as if it were stopped before the first trial.
Run look_up_all(Reproduction& reproduction, const Store& store) {
  std::stop_source stopped;
  stopped.request_stop();
  std::vector<Study*> studies;
  for (ReproductionStudy& part : reproduction.studies) studies.push_back(&part.study);
  return {run_studies(studies, store, {1, stopped.get_token(), {}}), kDone};
}

/// The trials of all studies that have not been run; readings share some.
std::size_t still_to_run(const std::vector<RunOutcome>& outcomes) {
  std::set<std::string> ids;
  for (const RunOutcome& outcome : outcomes) {
    for (std::size_t i = 0; i < outcome.outcomes.size(); ++i) {
      if (outcome.outcomes[i].state == Outcome::State::stopped) ids.insert(outcome.plan.trials[i].id);
    }
  }
  return ids.size();
}

Run run_all(Reproduction& reproduction, const Store& store, std::size_t threads) {
  SignalWatch signals;
  RunOptions how{threads, signals.token(), {}};
  how.watch = [](Progress& progress, const std::function<void()>& work) { show_progress(progress, work); };
  std::vector<Study*> studies;
  for (ReproductionStudy& part : reproduction.studies) studies.push_back(&part.study);
  return {run_studies(studies, store, how), signals.exit_code()};
}

PaperResults collect(Reproduction reproduction, const std::vector<RunOutcome>& outcomes, const Store& store,
                     std::size_t threads) {
  PaperResults results{std::move(reproduction), {}, {}, complaints(outcomes), provenance(), still_to_run(outcomes)};
  std::vector<Plan> plans;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    plans.push_back(outcomes[i].plan);
    results.summaries.push_back(summarise(results.reproduction.studies[i].study, plans[i], store, threads));
  }
  reduce_to_tables(results);
  results.verdicts = judge_paper(results.reproduction, plans, store, threads);
  return results;
}

/// "undecided (2)" where that few seeds cannot decide anything.
std::string ruling_text(const PaperVerdict& verdict) {
  const std::string name(ruling_name(verdict.verdict.ruling));
  return verdict.seeds > 0 && verdict.seeds < kSeedsForVerdict ? cat(name, " (", verdict.seeds, ")") : name;
}

std::string verdicts_text(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  const std::size_t columns = terminal_columns(STDOUT_FILENO, std::string::npos);
  std::string text;
  if (const std::string label = results.label(); !label.empty()) text += cat(label, "\n\n");
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty()) continue;
    const auto same = std::ranges::count_if(
        on, [&](const PaperVerdict* verdict) { return verdict->verdict.ruling == on.front()->verdict.ruling; });
    const std::string line = fmt::format("{:<4} {:<14} {:>2}/{:<2}  {}", paper.claims[c].id, ruling_text(*on.front()),
                                         same, on.size(), paper.claims[c].text);
    text += cat(fitted(line, columns), "\n");
  }
  if (!results.verdicts.empty())
    text += "\nThe second column: under how many of the readings that bear on it the verdict is the same.\n\n";
  for (const std::string& sentence : findings(results)) text += cat(sentence, "\n");
  return text;
}

std::string verdicts_json(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  Json claims = Json::array();
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  for (const PaperVerdict& verdict : results.verdicts) {
    claims.push_back({{"id", paper.claims[verdict.claim].id},
                      {"reading", paper.readings[verdict.reading].name},
                      {"verdict", ruling_name(verdict.verdict.ruling)},
                      {"estimate", number(verdict.measured.estimate)},
                      {"low", number(verdict.measured.low)},
                      {"high", number(verdict.measured.high)},
                      {"seeds", verdict.seeds},
                      {"share", number(verdict.share)},
                      {"one_training", number(verdict.one_training)},
                      {"reason", verdict.verdict.reason}});
  }
  return Json{{"paper", paper.name},           {"profile", results.reproduction.profile->name},
              {"label", results.label()},      {"missing", results.missing},
              {"findings", findings(results)}, {"claims", claims},
              {"failures", results.failures}}
      .dump(2, ' ', false, Json::error_handler_t::replace);
}

/// Refuses a folder that holds something else, before any work.
void check_folder(const std::filesystem::path& folder, const Reproduction& reproduction) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error) || std::filesystem::is_empty(folder, error)) return;
  if (holds_results(folder)) {
    const std::string other = command_text(read_results_choice(folder));
    if (other == command_text(reproduction)) return;
    throw Error(cat(folder.string(), ": holds what '", other, "' found; choose another --out"));
  }
  if (!std::filesystem::exists(folder / "store", error) || std::filesystem::exists(folder / "study.toml", error))
    throw Error(cat(folder.string(), ": holds something else; choose another --out"));
}

/// Refuses to put what has been run so far over results of more, as of another store.
void check_progress(const std::filesystem::path& folder, const std::vector<RunOutcome>& outcomes) {
  if (!holds_results(folder)) return;
  const std::size_t before = read_results_missing(folder), now = still_to_run(outcomes);
  if (now > before)
    throw Error(cat(folder.string(), ": has results that lack ", before, " trials, this store lacks ", now,
                    "; choose another --out"));
}

int reproduce(Options& options) {
  Reproduction reproduction = chosen_reproduction(options.paper, options.choice);
  check_claims(reproduction);
  const StudyFolder folder(options.out.empty() ? standard_folder(*reproduction.paper, options.choice) : options.out);
  check_folder(folder.path(), reproduction);
  const std::size_t threads = thread_count(options.threads);
  const Store store(folder.store(), Store::Access::write, tell);
  const Run run = options.so_far ? look_up_all(reproduction, store) : run_all(reproduction, store, threads);
  if (run.stopped != kDone) {
    tell("stopped; the same command goes on from here");
    return run.stopped;
  }
  if (options.so_far) check_progress(folder.path(), run.outcomes);
  const PaperResults results = collect(std::move(reproduction), run.outcomes, store, threads);
  for (const std::string& line : results.failures) tell(line);
  std::string page;
  try {
    write_results(results, folder.path());
    std::vector<Plan> plans;
    for (const RunOutcome& outcome : run.outcomes) plans.push_back(outcome.plan);
    write_headline_policies(results.reproduction, plans, store, folder.path());
    page = write_reproduction(results, folder.path());
  } catch (const Error& error) {  // the disk may be full by now, which must not hide the answer
    tell(error.what());
  }
  fmt::print("{}", options.json ? verdicts_json(results) + "\n" : verdicts_text(results));
  if (!options.json && !page.empty()) print_lines(cat("\nPage: ", page, "\n"));
  return results.failures.empty() && results.missing == 0 && !page.empty() ? kDone : kTrialFailed;
}

}  // namespace

void add_choice(CLI::App& command, ReproductionChoice& choice) {
  command.add_option("--only", choice.only, "of a paper: a figure or table by the name of its study; may be repeated")
      ->type_name("NAME");
  command.add_option("--seeds", choice.seeds, "of a paper: seeds of every training, 1 to N (default: the profile's)")
      ->check(whole_number(between(1, 10'000)))
      ->type_name("N");
  command
      .add_option("--profile", choice.profile, "of a paper: how much: paper, or quick, a miniature (default: paper)")
      ->type_name("paper|quick");
}

Reproduction chosen_reproduction(const std::string& paper, ReproductionChoice choice) {
  std::vector<std::string> once;
  for (const std::string& name : choice.only) {
    if (std::ranges::find(once, name) == once.end()) once.push_back(name);
  }
  choice.only = std::move(once);
  return open_reproduction(paper_at(paper), choice);
}

std::string standard_folder(const Paper& paper, const ReproductionChoice& choice) {
  return cat(paper.name, choice.profile == ReproductionChoice{}.profile ? "" : cat("-", choice.profile), ".gust");
}

std::string command_text(const Reproduction& reproduction) {
  const ReproductionChoice& choice = reproduction.choice;
  std::string text = cat("gust reproduce ", reproduction.paper->name);
  for (const std::string& name : choice.only) text += cat(" --only ", name);
  if (choice.seeds) text += cat(" --seeds ", *choice.seeds);
  return cat(text, " --profile ", choice.profile);
}

std::string write_reproduction(const PaperResults& results, const std::filesystem::path& folder) {
  const std::string command = command_text(results.reproduction);
  const std::filesystem::path page = folder / "report.html";
  write_file_atomically(page, render_reproduction(reproduction_page(results, command)));
  write_file_atomically(folder / "reproduce.md", reproduction_text(results, command));
  return page.string();
}

void command_reproduce(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("reproduce", "Runs a paper's studies and decides its claims");
  command->add_option("PAPER", options->paper, "the paper: 'paper'")->required();
  add_choice(*command, options->choice);
  command->add_option("--out", options->out, "result folder (default: ./paper.gust, or ./paper-quick.gust)")
      ->type_name("DIR");
  command->add_option("--threads", options->threads, "trials at a time (default: GUST_THREADS, else all cores)")
      ->check(whole_number(between(1, 1024)))
      ->type_name("N");
  command->add_flag("--so-far", options->so_far, "run nothing: judge what earlier runs have left");
  command->add_flag("--json", options->json, "verdicts as one JSON object");
  command->footer(
      "Examples:\n  gust reproduce paper --profile quick\n  gust reproduce paper --only table-dr --out table-dr.gust");
  command->callback([options, &exit_code] { exit_code = reproduce(*options); });
}

}  // namespace gust
