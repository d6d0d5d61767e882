#include "gust/study/trials/run_trials.h"

#include <time.h>

#include <algorithm>
#include <map>
#include <set>

#include "gust/store/checkpoint.h"
#include "gust/study/plan/timings.h"
#include "gust/study/trials/thread_executor.h"
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

/// The trials that the store lacks, each once, as jobs that need each other.
class MissingTrials {
 public:
  MissingTrials(std::span<const PlannedTrial> wanted, const Store& store) {
    std::vector<PlannedTrial> order(wanted.begin(), wanted.end());
    std::ranges::stable_sort(order, std::greater{}, [](const PlannedTrial& at) {  // trainings need nothing
      return at.trial().kind == Trial::Kind::kTrain ? at.trial().seconds : 0.0;
    });
    for (const PlannedTrial& at : order) add(at, store);
  }

  const std::vector<Job>& jobs() const { return jobs_; }
  const PlannedTrial& trial(const Job& job) const { return trials_[job_of_.at(job.id)]; }

  /// How a trial ended where the jobs ended like this.
  Outcome outcome(const Trial& trial, const std::vector<Outcome>& jobs) const {
    if (const auto job = job_of_.find(trial.id); job != job_of_.end()) return jobs[job->second];
    const auto input = lacks_.find(trial.id);
    if (input == lacks_.end()) return {};
    return {Outcome::State::skipped, cat("input missing: ", input->second->what, " (", input->second->id, ")")};
  }

 private:
  void add(const PlannedTrial& at, const Store& store) {
    const Trial& trial = at.trial();
    if (job_of_.contains(trial.id)) return;
    if (is_stored(*at.plan, trial, store) || training_failure(*at.plan, trial, store)) return;
    Job job{trial.id, std::string(kind_name(trial.kind)), trial.what, trial.seconds, {}};
    for (const std::size_t index : trial.inputs) {
      const Trial& input = at.plan->trials[index];
      if (const auto needed = job_of_.find(input.id); needed != job_of_.end()) {
        job.needs.push_back(needed->second);
      } else if (!stored_.contains(input.id) && !is_stored(*at.plan, input, store)) {
        lacks_[trial.id] = &input;
        return;
      }
    }
    job_of_[trial.id] = jobs_.size();
    jobs_.push_back(std::move(job));
    trials_.push_back(at);
  }

  bool is_stored(const Plan& plan, const Trial& trial, const Store& store) {
    const bool stored = load_trial(plan, trial, store, CheckDepth::whole).has_value();
    if (stored) stored_.insert(trial.id);
    return stored;
  }

  std::vector<Job> jobs_;
  std::vector<PlannedTrial> trials_;           ///< which one each job is
  std::map<std::string, std::size_t> job_of_;  ///< by the trial's id
  std::set<std::string> stored_;               ///< ids of those that were found whole
  std::map<std::string, const Trial*> lacks_;  ///< by the trial's id: an input that nobody makes
};

/// Runs a trial, and notes how long it took if all of its work was done here.
Outcome run_timed(const PlannedTrial& at, const Store& store, Timings& timings, std::stop_token stop,
                  ProgressSink& progress) {
  const Trial& trial = at.trial();
  const bool whole = !store.has(kind_name(trial.kind), trial.id) && !has_checkpoint(store, trial.id);
  const double begin = thread_seconds();
  Outcome outcome = run_trial(*at.study, *at.plan, at.index, store, std::move(stop), progress);
  if (whole && outcome.state == Outcome::State::done)
    timings.note(timing_kind(*at.study, trial), trial.guess, thread_seconds() - begin);
  return outcome;
}

/// A stored training that ended without a policy fails again, and what needs it is skipped.
Outcome judge_stored(const PlannedTrial& at, const Store& store, Outcome outcome) {
  if (outcome.state != Outcome::State::done) return outcome;
  const std::optional<std::string> failure = training_failure(*at.plan, at.trial(), store);
  if (!failure) return outcome;
  if (at.trial().kind == Trial::Kind::kTrain) return {Outcome::State::failed, *failure};
  return {Outcome::State::skipped, cat("its training failed: ", *failure)};
}

}  // namespace

std::vector<Outcome> run_trials(std::span<const PlannedTrial> trials, const Store& store, const RunOptions& options) {
  Timings timings(store.folder());
  const MissingTrials missing(trials, store);
  ThreadExecutor threads(options.threads, [&](const Job& job, std::stop_token stop, ProgressSink& progress) {
    return run_timed(missing.trial(job), store, timings, std::move(stop), progress);
  });
  Executor& executor = options.executor != nullptr ? *options.executor : threads;
  Progress progress(missing.jobs());
  std::vector<Outcome> results;
  const auto work = [&] { results = executor.run(missing.jobs(), options.stop, progress); };
  if (options.watch && !missing.jobs().empty()) {
    options.watch(progress, work);
  } else {
    work();
  }
  timings.save();
  std::vector<Outcome> outcomes;
  for (const PlannedTrial& at : trials)
    outcomes.push_back(judge_stored(at, store, missing.outcome(at.trial(), results)));
  return outcomes;
}

}  // namespace gust
