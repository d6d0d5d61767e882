#pragma once

#include "gust/store/store.h"
#include "gust/study/plan/plan.h"
#include "gust/study/trials/run_trials.h"

namespace gust {

/// How the trials of a study ended, in plan order.
struct RunOutcome {
  Plan plan;
  std::vector<Outcome> outcomes;
  bool stopped = false;

  std::size_t failed() const;
};

/// Runs what the store does not hold yet. Automatic sweeps get their levels as soon as their searches are done.
RunOutcome run_study(Study& study, const Store& store, const RunOptions& options);

/// The same of several studies at once: what they have in common is done once, and no thread waits for the last trial
/// of one study before it begins another. The longest trainings come first.
std::vector<RunOutcome> run_studies(const std::vector<Study*>& studies, const Store& store, const RunOptions& options);

/// The levels of the automatic sweeps whose searches the store holds.
FoundLevels found_levels(const Study& study, const Plan& plan, const Store& store);

/// The plan as far as the store knows it: found levels are put into the study.
Plan plan_with_store(Study& study, const Store& store);

}  // namespace gust
