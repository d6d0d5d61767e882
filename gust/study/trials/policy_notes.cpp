#include "gust/study/trials/policy_notes.h"

#include "gust/study/policies/file_policy.h"
#include "gust/study/trials/trial_check.h"

namespace gust {
namespace {

std::string told(const StudyPolicy& policy, std::size_t member, std::string_view what) {
  const std::string which = policy.count() > 1 ? cat(" (", policy.member(member), ")") : std::string();
  return cat("policy '", policy.name, "'", which, ": ", what);
}

/// How many of the undisturbed episodes failed within a second, and of how many.
std::string at_once_text(const MetricSet& metrics, const StoredTrial& stored, const std::string& name) {
  std::ifstream stream = stored.open(kRowsFile);
  RowsReader rows(stream, name);
  const RowsHeader header = rows.header();
  const std::optional<std::size_t> time = header.column(metrics.name_of(MetricRole::failure_time));
  const std::optional<std::size_t> survival = header.column(metrics.name_of(MetricRole::survival));
  if (!time || !survival) return {};
  const std::span<const double> cell = rows.next();
  std::size_t early = 0;
  for (std::size_t row = 0; row < cell.size(); row += header.metrics.size())
    early += cell[row + *survival] == 0 && cell[row + *time] <= kAtOnce ? 1 : 0;
  return failure_hint_text(early, cell.size() / header.metrics.size());
}

}  // namespace

std::string failure_hint_text(std::size_t early, std::size_t episodes) {
  if (2 * early <= episodes) return {};
  return cat("it fails within a second in ", early, " of ", episodes, " undisturbed episodes; ");
}

std::vector<std::string> policy_notes(const Study& study, const Plan& plan, const Store& store) {
  std::vector<std::string> notes;
  std::vector<bool> told_of(study.policies.size(), false);
  const auto tell_of = [&](const Trial& trial, const std::string& what) {
    if (what.empty() || told_of[trial.policy]) return;
    notes.push_back(told(study.policies[trial.policy], trial.member, what));
    told_of[trial.policy] = true;
  };
  for (const Trial& trial : plan.trials) {
    if (trial.kind != Trial::Kind::kEvaluate || told_of[trial.policy]) continue;
    if (!std::filesystem::exists(store.folder_of(kind_name(trial.kind), trial.id) / kNotFiniteFile))
      continue;  // most trials: read no rows
    const std::optional<StoredTrial> stored = load_trial(plan, trial, store);
    if (stored && stored->contains(kNotFiniteFile)) tell_of(trial, stored->read(kNotFiniteFile));
  }
  for (const Trial& trial : plan.trials) {
    const bool undisturbed = trial.sweep == Trial::kNominal && study.always.empty();
    if (trial.kind != Trial::Kind::kEvaluate || !undisturbed || !study.policies[trial.policy].source->foreign())
      continue;
    if (told_of[trial.policy]) continue;
    const std::optional<StoredTrial> stored = load_trial(plan, trial, store);
    const std::string failure = stored ? at_once_text(study.metric_set, *stored, trial.id) : std::string();
    if (!failure.empty()) tell_of(trial, failure + interface_hint(study.setup.plant->spec()));
  }
  return notes;
}

}  // namespace gust
