#include "gust/study/run.h"

#include <algorithm>
#include <map>

#include "gust/study/trials.h"

namespace gust {
namespace {

/// The trials that the store lacks, as jobs that need each other; `trials` says which trial each job is.
std::vector<Job> missing_jobs(const Study& study, const Plan& plan, const Store& store,
                              std::vector<std::size_t>& trials) {
  std::vector<std::size_t> job_of(plan.trials.size(), Trial::kNominal);
  std::map<std::string, std::size_t> first_of;  // trials of one name are done once: the others wait and find it done
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    if (store.load(kind_name(trial.kind), trial.id)) continue;
    Job job{trial.what, trial.seconds, {}, {}};
    for (const std::size_t input : trial.inputs) {
      if (job_of[input] != Trial::kNominal) job.needs.push_back(job_of[input]);
    }
    job.run = [&study, &plan, &store, i](std::stop_token stop, ProgressSink& progress) {
      return run_trial(study, plan, i, store, stop, progress);
    };
    const auto [first, is_first] = first_of.try_emplace(trial.id, jobs.size());
    if (!is_first) {
      job.needs.push_back(first->second);
      job.weight = 0;
    }
    job_of[i] = jobs.size();
    trials.push_back(i);
    jobs.push_back(std::move(job));
  }
  return jobs;
}

/// A stored training that ended without a policy fails again, and what needs it is skipped.
void judge_stored(const Plan& plan, const Store& store, RunOutcome& outcome) {
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    if (trial.kind != Trial::Kind::kTrain || outcome.outcomes[i].state != Outcome::State::done) continue;
    const std::optional<StoredTrial> stored = store.load(kind_name(trial.kind), trial.id);
    if (stored && stored->contains(kFailureFile)) {
      outcome.outcomes[i] = {Outcome::State::failed, stored->read(kFailureFile)};
    }
  }
}

RunOutcome run_plan(const Study& study, const Store& store, const RunOptions& options, Plan plan) {
  RunOutcome outcome{std::move(plan), {}, 0, false};
  std::vector<std::size_t> trials;
  const std::vector<Job> jobs = missing_jobs(study, outcome.plan, store, trials);
  Progress progress(jobs);
  std::vector<Outcome> results;
  const auto work = [&] { results = run_jobs(jobs, options.threads, options.stop, progress); };
  if (options.watch && !jobs.empty()) {
    options.watch(progress, work);
  } else {
    work();
  }
  outcome.outcomes.resize(outcome.plan.trials.size());
  outcome.found = outcome.plan.trials.size() - jobs.size();
  for (std::size_t j = 0; j < jobs.size(); ++j) outcome.outcomes[trials[j]] = results[j];
  outcome.stopped = options.stop.stop_requested();
  judge_stored(outcome.plan, store, outcome);
  return outcome;
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
    const std::optional<double> level = found_level(store, trial);
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
    found[sweep] = common_levels(levels, search_limit(study.sweeps[sweep].injection->site));
    add_claimed(study, study.sweeps[sweep], found[sweep]);
  }
  return found;
}

Plan plan_with_store(Study& study, const Store& store) {
  const FoundLevels found = found_levels(study, expand(study, {}), store);
  set_levels(study, found);
  return expand(study, found);
}

RunOutcome run_study(Study& study, const Store& store, const RunOptions& options) {
  RunOutcome outcome = run_plan(study, store, options, plan_with_store(study, store));
  if (outcome.plan.complete || outcome.stopped || outcome.failed() > 0) return outcome;
  const std::size_t found_before = outcome.found;
  outcome = run_plan(study, store, options, plan_with_store(study, store));
  outcome.found = found_before;
  return outcome;
}

}  // namespace gust
