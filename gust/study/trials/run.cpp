#include "gust/study/trials/run.h"

#include <algorithm>
#include <map>

#include "gust/study/plan/timings.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

/// Runs what the plans of the runs lack.
void run_plans(const std::vector<Study*>& studies, const Store& store, const RunOptions& options,
               std::vector<RunOutcome>& runs) {
  std::vector<PlannedTrial> all;
  for (std::size_t p = 0; p < runs.size(); ++p) {
    for (std::size_t t = 0; t < runs[p].plan.trials.size(); ++t) all.push_back({studies[p], &runs[p].plan, t});
  }
  const std::vector<Outcome> outcomes = run_trials(all, store, options);
  auto next = outcomes.begin();
  for (RunOutcome& run : runs) {
    const auto begin = next;
    next += static_cast<std::ptrdiff_t>(run.plan.trials.size());
    run.outcomes.assign(begin, next);
    run.stopped = options.stop.stop_requested();
  }
}

/// Adds the levels that claims are about.
void add_claimed(const Study& study, const Sweep& sweep, std::vector<double>& levels) {
  for (const StudyClaim& claim : study.claims) {
    if (claim.sweep == sweep.name) levels.push_back(claim.at.front());
  }
  std::ranges::sort(levels);
  levels.erase(std::ranges::unique(levels).begin(), levels.end());
}

}  // namespace

std::size_t RunOutcome::failed() const {
  return static_cast<std::size_t>(std::ranges::count_if(outcomes, [](const Outcome& outcome) {
    return outcome.state == Outcome::State::failed || outcome.state == Outcome::State::skipped;
  }));
}

FoundLevels found_levels(const Study& study, const Plan& plan, const Store& store) {
  std::map<std::size_t, std::vector<double>> failures;
  std::map<std::size_t, bool> complete;
  for (const Trial& trial : plan.trials) {
    if (trial.kind != Trial::Kind::kSearch) continue;
    if (training_failure(plan, trial, store)) continue;  // the others have levels without it
    const std::optional<double> level = found_level(plan, trial, store);
    complete.try_emplace(trial.sweep, true);
    if (level) {
      failures[trial.sweep].push_back(*level);
    } else {
      complete[trial.sweep] = false;
    }
  }
  FoundLevels found;
  for (const auto& [sweep, levels] : failures) {
    if (!complete[sweep]) continue;
    found[sweep] = common_levels(levels, search_limit(*study.sweeps[sweep].injection, study.setup.plant->spec()));
    add_claimed(study, study.sweeps[sweep], found[sweep]);
  }
  return found;
}

Plan plan_with_store(Study& study, const Store& store) {
  const Plan first = expand(study, {});
  std::set<std::string> failed;
  for (const Trial& trial : first.trials) {
    if (trial.kind == Trial::Kind::kTrain && training_failure(first, trial, store)) failed.insert(trial.id);
  }
  const FoundLevels found = found_levels(study, first, store);
  set_levels(study, found);
  Plan plan = expand(study, found, failed);
  predict(study, Timings(store.folder()), plan);
  return plan;
}

std::vector<RunOutcome> run_studies(const std::vector<Study*>& studies, const Store& store, const RunOptions& options) {
  std::vector<RunOutcome> runs;
  for (Study* study : studies) runs.push_back({plan_with_store(*study, store), {}, false});
  run_plans(studies, store, options, runs);

  // Those whose automatic sweeps have their levels by now, or whose margins are those of fewer seeds, go on.
  std::vector<std::size_t> waiting;
  std::vector<Study*> again;
  std::vector<RunOutcome> rest;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].stopped) continue;
    if (runs[i].plan.complete && runs[i].failed() == 0) continue;
    Plan plan = plan_with_store(*studies[i], store);
    if (std::ranges::equal(plan.trials, runs[i].plan.trials, {}, &Trial::id, &Trial::id)) continue;  // nothing new
    waiting.push_back(i);
    again.push_back(studies[i]);
    rest.push_back({std::move(plan), {}, false});
  }
  if (waiting.empty()) return runs;
  run_plans(again, store, options, rest);
  for (std::size_t k = 0; k < waiting.size(); ++k) runs[waiting[k]] = std::move(rest[k]);
  return runs;
}

RunOutcome run_study(Study& study, const Store& store, const RunOptions& options) {
  return std::move(run_studies({&study}, store, options).front());
}

}  // namespace gust
