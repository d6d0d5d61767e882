#pragma once

#include <functional>

#include "gust/study/trials/executor.h"

namespace gust {

/// Does the work of a job in this process; polls the token now and then and returns `stopped` soon after it fires. An
/// exception is a failure.
using RunJob = std::function<Outcome(const Job&, std::stop_token, ProgressSink&)>;

/// Runs jobs on threads of this process. Of those whose needs are done the first starts first.
class ThreadExecutor : public Executor {
 public:
  ThreadExecutor(std::size_t threads, RunJob run) : threads_(threads), run_(std::move(run)) {}

  std::vector<Outcome> run(std::span<const Job> jobs, std::stop_token stop, Progress& progress) override;

 private:
  std::size_t threads_;
  RunJob run_;
};

}  // namespace gust
