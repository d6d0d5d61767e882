#include <algorithm>
#include <set>

#include "gust/cli/command.h"
#include "gust/cli/environment.h"
#include "gust/cli/output_file.h"
#include "gust/cli/progress.h"
#include "gust/cli/progress_text.h"
#include "gust/cli/reproduction_answer.h"
#include "gust/cli/reproduction_command.h"
#include "gust/cli/signals.h"
#include "gust/cli/study_command.h"
#include "gust/core/text.h"
#include "gust/paper/reproduction_results.h"
#include "gust/report/html.h"
#include "gust/store/files.h"

namespace gust {
namespace {

struct Options {
  std::string paper, out;
  ReproductionChoice choice;
  std::vector<std::string> claims;   ///< whose parts are asked for
  std::vector<std::string> figures;  ///< "4", "S1"
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

/// What the trials measured; the reproduction and the outcomes must outlive it.
std::vector<std::unique_ptr<Measurements>> measured_studies(const Reproduction& reproduction,
                                                            const std::vector<RunOutcome>& outcomes,
                                                            const Store& store) {
  std::vector<std::unique_ptr<Measurements>> measured;
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    measured.push_back(stored_measurements(reproduction.studies[i].study, outcomes[i].plan, store));
  return measured;
}

/// Verdicts alone, without what a page needs: on the claims that are named, or on all.
PaperResults judged(Reproduction reproduction, const std::vector<RunOutcome>& outcomes, const Store& store,
                    std::size_t threads, const std::vector<std::string>& named = {}) {
  PaperResults results{std::move(reproduction), {}, {}, complaints(outcomes), provenance(), still_to_run(outcomes)};
  results.scores = std::make_shared<ScoreLog>();
  const auto measured = measured_studies(results.reproduction, outcomes, store);
  results.verdicts = judge_paper(results.reproduction, measured, threads, named, results.scores.get());
  return results;
}

PaperResults collect(Reproduction reproduction, const std::vector<RunOutcome>& outcomes, const Store& store,
                     std::size_t threads) {
  PaperResults results = judged(std::move(reproduction), outcomes, store, threads);
  for (const auto& measured : measured_studies(results.reproduction, outcomes, store))
    results.summaries.push_back(summarise(*measured, threads));
  reduce_to_tables(results);
  return results;
}

/// Refuses a folder that holds something else, before any work. Who is only told of claims leaves its results alone,
/// and may have asked for others.
void check_folder(const std::filesystem::path& folder, const Reproduction& reproduction, bool claims_only) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error) || std::filesystem::is_empty(folder, error)) return;
  if (holds_results(folder)) {
    if (claims_only) return;
    const ResultsHead other = read_results_head(folder);
    if (other.same_as(reproduction)) return;
    throw Error(cat(folder.string(), ": holds what '", command_text(other.folder.value_or(other.paper), other.choice),
                    "' found; choose another --out"));
  }
  if (!std::filesystem::exists(folder / "store", error) || std::filesystem::exists(folder / "study.toml", error))
    throw Error(cat(folder.string(), ": holds something else; choose another --out"));
}

/// Refuses to put what has been run so far over results of more, as of another store.
void check_progress(const std::filesystem::path& folder, const std::vector<RunOutcome>& outcomes) {
  if (!holds_results(folder)) return;
  const std::size_t before = read_results_head(folder).missing, now = still_to_run(outcomes);
  if (now > before)
    throw Error(cat(folder.string(), ": has results that lack ", before, " trials, this store lacks ", now,
                    "; choose another --out"));
}

/// Adds to what is to be run the studies of claims and figures that are asked for by name.
void add_asked(const Options& options, const Paper& paper, ReproductionChoice& choice) {
  for (const std::string& id : options.claims) {
    const auto claim = std::ranges::find(paper.claims, id, &PaperClaim::id);
    if (claim == paper.claims.end()) {
      std::vector<std::string> ids;
      for (const PaperClaim& known : paper.claims) ids.push_back(known.id);
      throw Error(
          cat("there is no claim '", id, "'", did_you_mean(id, ids), "; they are ", ids.front(), " to ", ids.back()));
    }
    choice.only.insert(choice.only.end(), claim->from.begin(), claim->from.end());
    for (const PaperPremise& premise : paper.premises) {
      if (std::ranges::find(premise.claims, id) != premise.claims.end())
        choice.only.insert(choice.only.end(), premise.from.begin(), premise.from.end());
    }
  }
  for (const std::string& number : options.figures) {
    const auto figure = std::ranges::find(paper.figures, cat("Figure ", number), &PaperFigure::place);
    if (figure == paper.figures.end()) {
      std::vector<std::string> places;
      for (const PaperFigure& known : paper.figures) places.push_back(known.place);
      throw Error(cat("there is no Figure ", number, "; there are ", join(places, ", ")));
    }
    choice.only.push_back(figure->study);
  }
}

/// Prints the answer; the exit code.
int answer(const std::string& text, const PaperResults& results, const Store& store) {
  const bool told = print_result(text, cat("the trials are in ", store.folder().string()));
  const bool whole = results.failures.empty() && results.missing == 0 && store.disagreements() == 0;
  return whole && told ? kDone : kTrialFailed;
}

/// What some claims need was run in the store of a folder, whose results stay as they are: tells their parts.
int tell_claims(const Options& options, const PaperResults& results, const Store& store) {
  for (const std::string& line : results.failures) tell(line);
  return answer(options.json ? verdicts_json(results) + "\n" : claims_text(results), results, store);
}

/// Judges, and writes results and page.
int tell_paper(const Options& options, Reproduction reproduction, const std::vector<RunOutcome>& outcomes,
               const Store& store, const StudyFolder& folder) {
  const PaperResults results = collect(std::move(reproduction), outcomes, store, thread_count(options.threads));
  for (const std::string& line : results.failures) tell(line);
  std::string page;
  try {
    write_results(results, folder.path());
    std::vector<Plan> plans;
    for (const RunOutcome& outcome : outcomes) plans.push_back(outcome.plan);
    write_headline_policies(results.reproduction, plans, store, folder.path());
    page = write_reproduction(results, folder.path());
  } catch (const Error& error) {  // the disk may be full by now, which must not hide the answer
    tell(error.what());
  }
  std::string text = options.json ? verdicts_json(results) + "\n" : verdicts_text(results);
  if (!options.json && !page.empty()) text += cat("\nPage: ", page, "\n");
  const int code = answer(text, results, store);
  return page.empty() ? kTrialFailed : code;
}

int reproduce(Options& options) {
  const Paper paper = open_paper(options.paper);
  add_asked(options, paper, options.choice);
  Reproduction reproduction = chosen_reproduction(paper, options.choice);
  check_claims(reproduction);
  const StudyFolder folder(options.out.empty() ? standard_folder(reproduction) : options.out);
  check_folder(folder.path(), reproduction, !options.claims.empty());
  if (!options.so_far) warn_of_plain_products();
  const std::size_t threads = thread_count(options.threads);
  const Store store(folder.store(), Store::Access::write, tell);
  const Run run = options.so_far ? look_up_all(reproduction, store) : run_all(reproduction, store, threads);
  if (run.stopped != kDone) {
    tell("stopped; the same command goes on from here");
    return run.stopped;
  }
  if (options.so_far && options.claims.empty()) check_progress(folder.path(), run.outcomes);
  try {
    if (options.claims.empty()) return tell_paper(options, std::move(reproduction), run.outcomes, store, folder);
    return tell_claims(options, judged(std::move(reproduction), run.outcomes, store, threads, options.claims), store);
  } catch (const std::exception& error) {
    if (options.so_far) throw;
    tell(error.what());
    tell(cat("what was run is safe in ", folder.path().string(), "; the same command goes on from there"));
    return kTrialFailed;
  }
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

Reproduction chosen_reproduction(const Paper& paper, ReproductionChoice choice) {
  std::vector<std::string> once;
  for (const std::string& name : choice.only) {
    if (std::ranges::find(once, name) == once.end()) once.push_back(name);
  }
  choice.only = std::move(once);
  return open_reproduction(paper, choice);
}

std::string standard_folder(const Reproduction& reproduction) {
  const Paper& paper = *reproduction.paper;
  const bool usual = reproduction.profile == &paper.profiles.front();
  return cat(paper.name, usual ? "" : cat("-", reproduction.profile->name), ".gust");
}

std::string command_text(const std::string& paper, const ReproductionChoice& choice) {
  std::string text = cat("gust reproduce ", shell_word(paper));
  for (const std::string& name : choice.only) text += cat(" --only ", name);
  if (choice.seeds) text += cat(" --seeds ", *choice.seeds);
  return cat(text, " --profile ", choice.profile);
}

std::string write_reproduction(const PaperResults& results, const std::filesystem::path& folder) {
  const std::string command = command_text(results.reproduction.paper->asked, results.reproduction.choice);
  const std::filesystem::path page = folder / "report.html";
  check_output(page, OutputKind::page, "page");
  write_file_atomically(page, render_reproduction(reproduction_page(results, command)));
  write_file_atomically(folder / "reproduce.md", reproduction_text(results, command));
  return page.string();
}

void command_reproduce(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("reproduce", "Runs a paper's studies and decides its claims");
  command
      ->add_option("PAPER", options->paper, "the paper: 'paper', or a folder with paper.toml, claims.toml and studies")
      ->required();
  add_choice(*command, options->choice);
  command->add_option("--claim", options->claims, "run what a claim needs, and tell all its parts; may be repeated")
      ->type_name("ID");
  command->add_option("--figure", options->figures, "a figure by its number in the paper, as --only; may be repeated")
      ->type_name("NUMBER");
  command->add_option("--out", options->out, "result folder (default: ./NAME.gust, or ./NAME-quick.gust)")
      ->type_name("DIR");
  command->add_option("--threads", options->threads, "trials at a time (default: GUST_THREADS, else all cores)")
      ->check(whole_number(between(1, 1024)))
      ->type_name("N");
  command->add_flag("--so-far", options->so_far, "run nothing: judge what earlier runs have left");
  command->add_flag("--json", options->json, "verdicts as one JSON object");
  command->footer(
      "Examples:\n  gust reproduce paper --profile quick\n  gust reproduce paper --only table-dr --out table-dr.gust\n"
      "  gust reproduce FOLDER");
  command->callback([options, &exit_code] { exit_code = reproduce(*options); });
}

}  // namespace gust
