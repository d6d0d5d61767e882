#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace gust {

/// How a job ended.
struct Outcome {
  enum class State {
    done,
    failed,   ///< it threw, or said so; `reason` says why
    skipped,  ///< one of its inputs is missing
    stopped,  ///< not begun, or left before its end, because a stop was asked for
  };
  State state = State::done;
  std::string reason;
};

struct Job;

/// Where the jobs stand. Written by the threads that run them, read by whoever draws it, without a lock.
class Progress {
 public:
  /// A moment of the run.
  struct Moment {
    double fraction = 0;  ///< of the predicted work, 0 to 1
    std::size_t finished = 0;
    std::size_t jobs = 0;
    std::vector<std::string> running;  ///< names, in plan order
  };

  explicit Progress(std::span<const Job> jobs);

  Moment now() const;
  void start(std::size_t job);
  /// The share of a job's work that is done, 0 to 1.
  void advance(std::size_t job, double fraction);
  void finish(std::size_t job);

 private:
  struct Entry {
    std::string name;
    double weight = 0;
    std::atomic<double> fraction = 0;
    std::atomic<bool> running = false;
    std::atomic<bool> finished = false;
  };
  std::vector<Entry> entries_;
};

/// What a running job tells its progress.
class ProgressSink {
 public:
  ProgressSink(Progress& progress, std::size_t job) : progress_(progress), job_(job) {}
  void set(double fraction) { progress_.advance(job_, fraction); }

 private:
  Progress& progress_;
  std::size_t job_;
};

/// A piece of work: a trial.
struct Job {
  std::string name;                ///< as the progress shows it
  double weight = 1;               ///< predicted seconds
  std::vector<std::size_t> needs;  ///< indices of earlier jobs that must be done first
  /// Does the work; polls the token now and then and returns `stopped` soon after it fires. An exception is a failure.
  std::function<Outcome(std::stop_token, ProgressSink&)> run;
};

/// Runs the jobs on this many threads and returns their outcomes in the order of the jobs. Of the jobs whose inputs are
/// done the first starts first. A job that fails takes nothing with it but those that need it. After a stop no job
/// begins; those that had not are `stopped`, and `finished` is not told of them. It hears of the others as they end,
/// one call at a time.
std::vector<Outcome> run_jobs(std::span<const Job> jobs, std::size_t threads, std::stop_token stop, Progress& progress,
                              const std::function<void(std::size_t, const Outcome&)>& finished = {});

}  // namespace gust
