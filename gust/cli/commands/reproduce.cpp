#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "gust/cli/command.h"
#include "gust/cli/environment.h"
#include "gust/cli/progress.h"
#include "gust/cli/progress_text.h"
#include "gust/cli/reproduction_command.h"
#include "gust/cli/signals.h"
#include "gust/cli/study_command.h"
#include "gust/core/text.h"
#include "gust/report/html.h"
#include "gust/report/reproduction_results.h"
#include "gust/study/files.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

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

/// Verdicts alone, without what a page needs: on the claims that are named, or on all.
PaperResults judged(Reproduction reproduction, const std::vector<RunOutcome>& outcomes, const Store& store,
                    std::size_t threads, const std::vector<std::string>& named = {}) {
  PaperResults results{std::move(reproduction), {}, {}, complaints(outcomes), provenance(), still_to_run(outcomes)};
  std::vector<Plan> plans;
  for (const RunOutcome& outcome : outcomes) plans.push_back(outcome.plan);
  results.scores = std::make_shared<ScoreLog>();
  results.verdicts = judge_paper(results.reproduction, plans, store, threads, named, results.scores.get());
  return results;
}

PaperResults collect(Reproduction reproduction, const std::vector<RunOutcome>& outcomes, const Store& store,
                     std::size_t threads) {
  PaperResults results = judged(std::move(reproduction), outcomes, store, threads);
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    results.summaries.push_back(summarise(results.reproduction.studies[i].study, outcomes[i].plan, store, threads));
  reduce_to_tables(results);
  return results;
}

/// "open (2)" where that few seeds cannot decide anything.
std::string grade_text(const PaperVerdict& verdict) {
  const std::string name(grade_name(verdict.grade()));
  return verdict.seeds > 0 && verdict.seeds < kSeedsForVerdict ? cat(name, " (", verdict.seeds, ")") : name;
}

/// Claims of the figures that were run which need another study as well.
std::string left_out_text(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    const PaperClaim& claim = paper.claims[c];
    std::vector<std::string> missing;
    for (const std::string& study : claim.from) {
      if (!results.reproduction.find(0, study)) missing.push_back(study);
    }
    if (!missing.empty() && missing.size() < claim.from.size())
      parts.push_back(cat(claim.id, " needs ", join(missing, " and ")));
  }
  return parts.empty() ? "" : cat("Not asked: ", join(parts, "; "), " (--only).");
}

/// A text that is wrapped in the columns beside the head of its line.
std::string beside(const std::string& head, const std::string& text, std::size_t columns) {
  const std::size_t indent = text_width(head);
  return cat(head, wrapped(text, columns - std::min(columns - 1, indent), indent));
}

/// A verdict with every part: what became of it, by how much it is true, and what its names stand for.
std::string parts_text(const Paper& paper, const PaperVerdict& verdict, std::size_t columns) {
  std::string text = cat(paper.readings[verdict.reading].name, ": ", grade_name(verdict.grade()), ", ",
                         verdict.true_parts, " of ", counted(verdict.parts, "part", "parts"), " true");
  if (verdict.left_out_parts > 0) text += cat(", ", verdict.left_out_parts, " not comparable");
  text = cat(wrapped(cat(text, "; ", verdict.verdict.reason), columns), "\n");
  std::string statement;
  for (const PartFinding& part : verdict.each_part) {
    if (part.statement != statement) {
      statement = part.statement;
      std::string line = statement;
      std::ranges::replace(line, '\n', ' ');
      text += cat("  ", wrapped(line, columns - 2, 2), "\n");
    }
    Interval margin = part.margin;
    margin.unit = Unit::none;
    const std::string_view ruling = part.ruling == Ruling::holds   ? "shown"
                                    : part.ruling == Ruling::fails ? "refuted"
                                    : part.is_true                 ? "open, true"
                                                                   : "open, false";
    const std::string head = fmt::format("    {:<12} {:<28} ", ruling, interval_text(margin));
    text += cat(beside(head, part.label, columns), "\n");
  }
  return text;
}

/// Claims with all their parts, under the reading that decides and the others.
std::string claims_text(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  const std::size_t columns = terminal_columns(STDOUT_FILENO, kUsualColumns);
  std::string text;
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty()) continue;
    text += cat(wrapped(cat(paper.claims[c].id, ": ", paper.claims[c].text), columns), "\n\n");
    for (const PaperVerdict* verdict : on) {
      if (verdict == on.front())
        text += cat(parts_text(paper, *verdict, columns), on.size() > 1 ? "\nOther readings\n" : "");
      else
        text += fmt::format("  {:<24} {:<16} {} of {} true\n", paper.readings[verdict->reading].name,
                            grade_name(verdict->grade()), verdict->true_parts, verdict->parts);
    }
    text += "\n";
  }
  return text;
}

std::string verdicts_text(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  const std::size_t columns = terminal_columns(STDOUT_FILENO, kUsualColumns);
  std::string text;
  if (const std::string label = results.label(); !label.empty()) text += cat(wrapped(label, columns), "\n\n");
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty()) continue;
    const auto same =
        std::ranges::count_if(on, [&](const PaperVerdict* verdict) { return verdict->grade() == on.front()->grade(); });
    const std::string head =
        fmt::format("{:<4} {:<15} {:>2}/{:<2}  ", paper.claims[c].id, grade_text(*on.front()), same, on.size());
    text += cat(beside(head, paper.claims[c].text, columns), "\n");
  }
  if (!results.verdicts.empty())
    text += cat(
        "\n",
        wrapped("The second column: under how many of the readings that bear on it the verdict is the same.", columns),
        "\n\n");
  if (const std::string left_out = left_out_text(results); !left_out.empty())
    text += cat(wrapped(left_out, columns), "\n\n");
  for (const std::string& sentence : opening_findings(results)) text += cat(wrapped(sentence, columns), "\n");
  return text;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json parts_json(const PaperVerdict& verdict) {
  Json parts = Json::array();
  for (const PartFinding& part : verdict.each_part)
    parts.push_back({{"statement", part.statement},
                     {"names", part.label},
                     {"verdict", ruling_name(part.ruling)},
                     {"true", part.is_true},
                     {"estimate", number(part.margin.estimate)},
                     {"low", number(part.margin.low)},
                     {"high", number(part.margin.high)}});
  return parts;
}

Json all_findings(const PaperResults& results) {
  if (results.summaries.empty()) return Json::array();
  Findings found = findings(results);
  std::ranges::move(found.further, std::back_inserter(found.opening));
  return found.opening;
}

std::string verdicts_json(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  Json claims = Json::array();
  for (const PaperVerdict& verdict : results.verdicts) {
    claims.push_back({{"id", paper.claims[verdict.claim].id},
                      {"reading", paper.readings[verdict.reading].name},
                      {"verdict", ruling_name(verdict.verdict.ruling)},
                      {"grade", grade_name(verdict.grade())},
                      {"parts", parts_json(verdict)},
                      {"left_out_parts", verdict.left_out_parts},
                      {"estimate", number(verdict.measured.estimate)},
                      {"low", number(verdict.measured.low)},
                      {"high", number(verdict.measured.high)},
                      {"seeds", verdict.seeds},
                      {"share", number(verdict.share)},
                      {"one_training", number(verdict.one_training)},
                      {"reason", verdict.verdict.reason}});
  }
  return Json{{"paper", paper.name},
              {"profile", results.reproduction.profile->name},
              {"label", results.label()},
              {"missing", results.missing},
              {"findings", all_findings(results)},
              {"claims", claims},
              {"failures", results.failures}}
      .dump(2, ' ', false, Json::error_handler_t::replace);
}

/// Refuses a folder that holds something else, before any work. Who is only told of claims leaves its results alone,
/// and may have asked for others.
void check_folder(const std::filesystem::path& folder, const Reproduction& reproduction, bool claims_only) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error) || std::filesystem::is_empty(folder, error)) return;
  if (holds_results(folder)) {
    if (claims_only) return;
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

/// Adds to what is to be run the studies of claims and figures that are asked for by name.
void add_asked(const Options& options, ReproductionChoice& choice) {
  const Paper& paper = paper_at(options.paper);
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

/// Runs what some claims need in the store of a folder, whose results stay as they are, and tells their parts.
int tell_claims(const Options& options, const PaperResults& results) {
  for (const std::string& line : results.failures) tell(line);
  fmt::print("{}", options.json ? verdicts_json(results) + "\n" : claims_text(results));
  return results.failures.empty() && results.missing == 0 ? kDone : kTrialFailed;
}

int reproduce(Options& options) {
  add_asked(options, options.choice);
  Reproduction reproduction = chosen_reproduction(options.paper, options.choice);
  check_claims(reproduction);
  const StudyFolder folder(options.out.empty() ? standard_folder(*reproduction.paper, options.choice) : options.out);
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
  if (!options.claims.empty())
    return tell_claims(options, judged(std::move(reproduction), run.outcomes, store, threads, options.claims));
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
  const bool whole = results.failures.empty() && results.missing == 0 && store.disagreements() == 0;
  return whole && !page.empty() ? kDone : kTrialFailed;
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
  command->add_option("--claim", options->claims, "run what a claim needs, and tell all its parts; may be repeated")
      ->type_name("ID");
  command->add_option("--figure", options->figures, "a figure by its number in the paper, as --only; may be repeated")
      ->type_name("NUMBER");
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
