#pragma once

#include <functional>
#include <span>

#include "gust/store/store.h"
#include "gust/study/plan/plan.h"
#include "gust/study/trials/executor.h"

namespace gust {

/// How trials are run; nothing here changes a number.
struct RunOptions {
  std::size_t threads = 1;
  std::stop_token stop;
  /// Called around each batch of work: shows the progress while `work` runs. May be empty.
  std::function<void(Progress&, const std::function<void()>& work)> watch;
  Executor* executor = nullptr;  ///< what runs the trials; none: that many threads of this process
};

/// A trial of one of several studies.
struct PlannedTrial {
  const Study* study;
  const Plan* plan;
  std::size_t index;

  const Trial& trial() const { return plan->trials[index]; }
};

/// Runs those of the trials that the store lacks, and returns how each ended: one that was there is done, one whose
/// training ended without a policy is failed or skipped, as is one whose inputs are neither among the trials nor in the
/// store. A trial comes after its inputs. What several studies have in common is run once, the longest trainings first.
std::vector<Outcome> run_trials(std::span<const PlannedTrial> trials, const Store& store, const RunOptions& options);

}  // namespace gust
