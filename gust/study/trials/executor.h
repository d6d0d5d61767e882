#pragma once

#include <atomic>
#include <cstddef>
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

/// A trial that is to be run. Its id says all to whoever has the study: nothing here is tied to this process.
struct Job {
  std::string id;                  ///< of the trial, "ppo-s1-3f…"
  std::string kind;                ///< of the trial, "train": with the id its place in the store
  std::string what;                ///< for people: "train ppo seed 1"
  double seconds = 0;              ///< predicted, on one core
  std::vector<std::size_t> needs;  ///< indices of earlier jobs that must be done first
};

/// Where the jobs stand. Written by the threads that run them, read by whoever draws it, without a lock.
class Progress {
 public:
  /// A moment of the run.
  struct Moment {
    double fraction = 0;  ///< of the predicted work, 0 to 1
    std::size_t finished = 0;
    std::size_t jobs = 0;
    std::vector<std::string> running;  ///< what they do, in plan order
  };

  explicit Progress(std::span<const Job> jobs);

  Moment now() const;
  void start(std::size_t job);
  /// The share of a job's work that is done, 0 to 1.
  void advance(std::size_t job, double fraction);
  void finish(std::size_t job);

 private:
  struct Entry {
    std::string what;
    double seconds = 0;
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

/// What runs trials: threads of this process (thread_executor.h), other processes, other machines. Jobs hand nothing to
/// each other but what they leave in the store.
class Executor {
 public:
  virtual ~Executor() = default;

  /// Runs the jobs, each after those that it needs, tells `progress` as they begin and end, and returns their outcomes
  /// in the order of the jobs. A job that fails takes nothing with it but those that need it, which are skipped. After
  /// a stop no job begins; those that had not are `stopped`.
  virtual std::vector<Outcome> run(std::span<const Job> jobs, std::stop_token stop, Progress& progress) = 0;
};

}  // namespace gust
