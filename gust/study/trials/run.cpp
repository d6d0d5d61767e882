#include "gust/study/trials/run.h"

#include <time.h>

#include <algorithm>
#include <map>

#include "gust/store/checkpoint.h"
#include "gust/study/plan/timings.h"
#include "gust/study/trials/trial_check.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

/// Seconds that this thread has spent on a processor.
double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// A trial of one of several plans.
struct PlannedTrial {
  std::size_t plan = 0;
  std::size_t trial = 0;
};

/// The trials that the store lacks, as jobs that need each other.
class MissingJobs {
 public:
  std::vector<Job> jobs;
  std::vector<PlannedTrial> trials;  ///< which one each job is

  /// Plans and studies must outlive the jobs.
  MissingJobs(const std::vector<Study*>& studies, const std::vector<RunOutcome>& runs, const Store& store,
              Timings& timings)
      : timings_(timings) {
    std::vector<PlannedTrial> all;
    for (std::size_t p = 0; p < runs.size(); ++p) {
      job_of_.emplace_back(runs[p].plan.trials.size(), Trial::kNominal);
      for (std::size_t t = 0; t < runs[p].plan.trials.size(); ++t) all.push_back({p, t});
    }
    const auto seconds_first = [&](const PlannedTrial& at) {  // of trainings, which need nothing
      const Trial& trial = runs[at.plan].plan.trials[at.trial];
      return trial.kind == Trial::Kind::kTrain ? trial.seconds : 0.0;
    };
    if (runs.size() > 1) std::ranges::stable_sort(all, std::greater{}, seconds_first);
    for (const PlannedTrial& at : all) add(*studies[at.plan], runs[at.plan].plan, at, store);
  }

 private:
  void add(const Study& study, const Plan& plan, const PlannedTrial& at, const Store& store) {
    const Trial& trial = plan.trials[at.trial];
    if (load_trial(plan, trial, store, CheckDepth::whole) || training_failure(plan, trial, store)) return;
    Job job{trial.what, trial.seconds, {}, {}};
    for (const std::size_t input : trial.inputs) {
      if (job_of_[at.plan][input] != Trial::kNominal) job.needs.push_back(job_of_[at.plan][input]);
    }
    const auto [first, is_first] = first_of_.try_emplace(trial.id, jobs.size());
    if (!is_first) {  // trials of one name are done once: the others wait and find it done
      job.needs.push_back(first->second);
      job.weight = 0;
    }
    job.run = [this, &study, &plan, &store, index = at.trial, alone = is_first](std::stop_token stop,
                                                                                ProgressSink& progress) {
      const Trial& trial = plan.trials[index];
      const bool whole = alone && !has_checkpoint(store, trial.id);  // it does all of the work
      const double begin = thread_seconds();
      Outcome outcome = run_trial(study, plan, index, store, stop, progress);
      if (whole && outcome.state == Outcome::State::done)
        timings_.note(timing_kind(study, trial), trial.guess, thread_seconds() - begin);
      return outcome;
    };
    job_of_[at.plan][at.trial] = jobs.size();
    trials.push_back(at);
    jobs.push_back(std::move(job));
  }

  Timings& timings_;
  std::vector<std::vector<std::size_t>> job_of_;
  std::map<std::string, std::size_t> first_of_;
};

/// A stored training that ended without a policy fails again, and what needs it is skipped.
void judge_stored(const Plan& plan, const Store& store, RunOutcome& outcome) {
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    if (outcome.outcomes[i].state != Outcome::State::done) continue;
    const std::optional<std::string> failure = training_failure(plan, trial, store);
    if (!failure) continue;
    const bool itself = trial.kind == Trial::Kind::kTrain;
    outcome.outcomes[i] = {itself ? Outcome::State::failed : Outcome::State::skipped,
                           itself ? *failure : cat("its training failed: ", *failure)};
  }
}

/// Runs what the plans of the runs lack.
void run_plans(const std::vector<Study*>& studies, const Store& store, const RunOptions& options,
               std::vector<RunOutcome>& runs) {
  Timings timings(store.folder());
  MissingJobs missing(studies, runs, store, timings);
  Progress progress(missing.jobs);
  std::vector<Outcome> results;
  const auto work = [&] { results = run_jobs(missing.jobs, options.threads, options.stop, progress); };
  if (options.watch && !missing.jobs.empty()) {
    options.watch(progress, work);
  } else {
    work();
  }
  timings.save();
  for (RunOutcome& run : runs) {
    run.outcomes.assign(run.plan.trials.size(), {});
    run.stopped = options.stop.stop_requested();
  }
  for (std::size_t j = 0; j < missing.jobs.size(); ++j)
    runs[missing.trials[j].plan].outcomes[missing.trials[j].trial] = results[j];
  for (RunOutcome& run : runs) judge_stored(run.plan, store, run);
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
    found[sweep] = common_levels(levels, search_limit(study.sweeps[sweep].injection->site));
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
