#include "gust/study/trials/member_rows.h"

#include <algorithm>

#include "gust/eval/metric.h"
#include "gust/stats/quotient.h"
#include "gust/study/trials/trial_check.h"
#include "gust/study/trials/trials.h"

namespace gust {

std::vector<TrialGroup> trial_groups(const Plan& plan) {
  std::vector<TrialGroup> groups;
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    if (trial.kind != Trial::Kind::kEvaluate) continue;
    const auto same = [&](const TrialGroup& group) {
      return group.policy == trial.policy && group.sweep == trial.sweep;
    };
    auto at = std::ranges::find_if(groups, same);
    if (at == groups.end()) at = groups.insert(groups.end(), {trial.policy, trial.sweep, {}});
    at->trials.push_back(i);
  }
  return groups;
}

bool episodes_repeat(const Study& study, std::size_t sweep, std::size_t start) {
  if (study.starts[start].random) return false;
  const auto random = [](const Injection& injection) { return injection.waveform->random(); };
  if (std::ranges::any_of(study.always, random)) return false;
  if (sweep == Trial::kNominal) return true;
  const Sweep& swept = study.sweeps[sweep];
  return !std::ranges::any_of(swept.disturbed, random) && !(swept.injection && random(*swept.injection));
}

MemberRows::MemberRows(const Plan& plan, const TrialGroup& group, const Store& store,
                       std::vector<std::string>& missing) {
  for (const std::size_t index : group.trials) {
    const Trial& trial = plan.trials[index];
    std::optional<StoredTrial> stored = load_trial(plan, trial, store);
    if (!stored) {
      missing.push_back(trial.what);
      continue;
    }
    streams_.push_back(std::make_unique<std::ifstream>(stored->open(kRowsFile)));
    readers_.emplace_back(*streams_.back(), (stored->folder / kRowsFile).string());
    remedy_ = Store::remedy(store.folder());
  }
}

MemberRows::MemberRows(const StoredTrial& stored, const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    streams_.push_back(std::make_unique<std::ifstream>(stored.open(file)));
    readers_.emplace_back(*streams_.back(), (stored.folder / file).string());
    remedy_ = Store::remedy(stored.folder.parent_path().parent_path());
  }
}

bool MemberRows::next() {
  cells_.clear();
  try {
    for (RowsReader& reader : readers_) cells_.push_back(reader.next());
  } catch (const Error& error) {
    throw Error(cat(error.what(), remedy_));
  }
  return !cells_.empty() && !cells_.front().empty();
}

bool MemberRows::has(std::string_view metric) const {
  if (const auto quotient = quotient_of(metric)) return has(quotient->numerator) && has(quotient->denominator);
  return std::ranges::all_of(readers_,
                             [&](const RowsReader& reader) { return reader.header().column(metric).has_value(); });
}

Matrix<double> MemberRows::values(std::size_t start, std::string_view metric, bool repeats) const {
  if (const auto quotient = quotient_of(metric))
    return quotient_values(values(start, quotient->numerator, repeats).view(),
                           values(start, quotient->denominator, repeats).view());
  GUST_CHECK(has(metric));
  const auto stored = static_cast<std::size_t>(header().episodes);
  const std::size_t episodes = repeats ? 1 : stored;
  Matrix<double> values(cells_.size(), episodes);
  for (std::size_t m = 0; m < cells_.size(); ++m) {
    const RowsHeader& its = readers_[m].header();  // of another version, it may have other metrics
    const std::size_t metrics = its.metrics.size();
    const double* first = cells_[m].data() + start * stored * metrics + *its.column(metric);
    for (std::size_t e = 0; e < episodes; ++e) values.at(m, e) = first[e * metrics];
  }
  return values;
}

}  // namespace gust
