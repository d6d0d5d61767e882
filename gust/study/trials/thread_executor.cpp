#include "gust/study/trials/thread_executor.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <set>

#include "gust/core/crew.h"
#include "gust/core/error.h"

namespace gust {
namespace {

/// Runs one job. This is the place "around a trial": whatever it throws is its failure and nobody else's.
Outcome run_one(const RunJob& run, const Job& job, std::stop_token stop, ProgressSink& sink) try {
  return run(job, std::move(stop), sink);
} catch (const Error& error) {
  return {Outcome::State::failed, error.what()};
} catch (const std::bad_alloc&) {
  return {Outcome::State::failed, "out of memory"};
} catch (const std::exception& bug) {
  return {Outcome::State::failed, cat("internal error: ", bug.what())};
} catch (...) {
  return {Outcome::State::failed, "internal error"};
}

/// The queue that the threads share.
class Queue {
 public:
  Queue(std::span<const Job> jobs, const RunJob& run, Progress& progress)
      : jobs_(jobs), run_(run), progress_(progress), needed_by_(jobs.size()), missing_(jobs.size()) {
    outcomes_.resize(jobs.size(), {Outcome::State::stopped, ""});
    is_settled_.resize(jobs.size());
    for (std::size_t job = 0; job < jobs.size(); ++job) {
      for (const std::size_t need : jobs[job].needs) {
        GUST_CHECK(need < job);
        needed_by_[need].push_back(job);
      }
      missing_[job] = jobs[job].needs.size();
      if (missing_[job] == 0) ready_.insert(job);
    }
  }

  /// What each thread does: takes jobs until none is left that could be begun. If it cannot go on, for want of memory,
  /// the others stop as well.
  void work(const std::stop_token& stop) {
    try {
      take_jobs(stop);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      broken_ = true;
      changed_.notify_all();
      throw;
    }
  }

  std::vector<Outcome> outcomes() && { return std::move(outcomes_); }

 private:
  void take_jobs(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, stop, [&] { return !ready_.empty() || settled_ == jobs_.size() || broken_; });
      if (stop.stop_requested() || ready_.empty() || broken_) return;
      const std::size_t job = *ready_.begin();
      ready_.erase(ready_.begin());
      lock.unlock();
      progress_.start(job);
      ProgressSink sink(progress_, job);
      Outcome outcome = run_one(run_, jobs_[job], stop, sink);
      lock.lock();
      settle(job, std::move(outcome));
    }
  }

  /// Notes how a job ended and what that means for those that wait for it. The lock is held.
  void settle(std::size_t job, Outcome outcome) {
    outcomes_[job] = std::move(outcome);
    is_settled_[job] = true;
    ++settled_;
    if (outcomes_[job].state != Outcome::State::stopped) progress_.finish(job);
    for (const std::size_t waiting : needed_by_[job]) {
      if (outcomes_[job].state != Outcome::State::done) {
        give_up(waiting, job);
      } else if (--missing_[waiting] == 0) {
        ready_.insert(waiting);
      }
    }
    changed_.notify_all();
  }

  /// Settles a job that cannot begin, because an input of it was not made.
  void give_up(std::size_t job, std::size_t input) {
    if (is_settled_[job]) return;
    const bool stopped = outcomes_[input].state == Outcome::State::stopped;
    if (stopped) settle(job, {Outcome::State::stopped, ""});
    if (!stopped) settle(job, {Outcome::State::skipped, cat("input missing: ", jobs_[input].what)});
  }

  std::span<const Job> jobs_;
  const RunJob& run_;
  Progress& progress_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<std::vector<std::size_t>> needed_by_;
  std::vector<std::size_t> missing_;  ///< inputs of each job that are not done yet
  std::set<std::size_t> ready_;
  std::vector<bool> is_settled_;
  std::size_t settled_ = 0;
  bool broken_ = false;  ///< a thread had to give up
  std::vector<Outcome> outcomes_;
};

}  // namespace

std::vector<Outcome> ThreadExecutor::run(std::span<const Job> jobs, std::stop_token stop, Progress& progress) {
  Queue queue(jobs, run_, progress);
  run_crew(std::min(threads_, jobs.size()), [&] { queue.work(stop); });
  return std::move(queue).outcomes();
}

}  // namespace gust
