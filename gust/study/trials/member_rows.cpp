#include "gust/study/trials/member_rows.h"

#include <algorithm>
#include <fstream>

#include "gust/eval/metric.h"
#include "gust/stats/quotient.h"
#include "gust/study/trials/trial_check.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

/// A rows file of a trial in a store.
class StoredCells final : public CellSource {
 public:
  StoredCells(const StoredTrial& stored, const std::string& file)
      : stream_(stored.open(file)),
        reader_(stream_, (stored.folder / file).string()),
        store_(stored.folder.parent_path().parent_path()) {}

  const RowsHeader& header() const override { return reader_.header(); }
  std::span<const double> next() override {
    try {
      return reader_.next();
    } catch (const Error& error) {
      throw Error(cat(error.what(), Store::remedy(store_)));
    }
  }

 private:
  std::ifstream stream_;
  RowsReader reader_;
  std::filesystem::path store_;
};

std::vector<bool> repeating_starts(const Study& study, std::size_t sweep) {
  std::vector<bool> repeats;
  for (std::size_t start = 0; start < study.starts.size(); ++start)
    repeats.push_back(episodes_repeat(study, sweep, start));
  return repeats;
}

}  // namespace

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
  const auto random = [](const Injection& injection) { return injection.random(); };
  if (std::ranges::any_of(study.always, random)) return false;
  if (sweep == Trial::kNominal) return true;
  const Sweep& swept = study.sweeps[sweep];
  return !std::ranges::any_of(swept.disturbed, random) && !(swept.injection && random(*swept.injection));
}

bool MemberRows::next() {
  cells_.clear();
  for (const auto& source : sources_) cells_.push_back(source->next());
  return !cells_.empty() && !cells_.front().empty();
}

bool MemberRows::has(std::string_view metric) const {
  if (const auto quotient = quotient_of(metric)) return has(quotient->numerator) && has(quotient->denominator);
  return std::ranges::all_of(sources_, [&](const auto& source) { return source->header().column(metric).has_value(); });
}

Matrix<double> MemberRows::values(std::size_t start, std::string_view metric) const {
  if (const auto quotient = quotient_of(metric))
    return quotient_values(values(start, quotient->numerator).view(), values(start, quotient->denominator).view());
  GUST_CHECK(has(metric));
  const auto stored = static_cast<std::size_t>(header().episodes);
  const std::size_t episodes = repeats_[start] ? 1 : stored;
  Matrix<double> values(cells_.size(), episodes);
  for (std::size_t m = 0; m < cells_.size(); ++m) {
    const RowsHeader& its = sources_[m]->header();  // of another version, it may have other metrics
    const std::size_t metrics = its.metrics.size();
    const double* first = cells_[m].data() + start * stored * metrics + *its.column(metric);
    for (std::size_t e = 0; e < episodes; ++e) values.at(m, e) = first[e * metrics];
  }
  return values;
}

MemberRows stored_rows(const Study& study, const Plan& plan, const TrialGroup& group, const Store& store,
                       std::vector<std::string>& missing) {
  std::vector<std::unique_ptr<CellSource>> members;
  for (const std::size_t index : group.trials) {
    const Trial& trial = plan.trials[index];
    const std::optional<StoredTrial> stored = load_trial(plan, trial, store);
    if (stored) members.push_back(std::make_unique<StoredCells>(*stored, std::string(kRowsFile)));
    if (!stored) missing.push_back(trial.what);
  }
  return {std::move(members), repeating_starts(study, group.sweep)};
}

MemberRows stored_rows(const Study& study, std::size_t sweep, const StoredTrial& stored,
                       const std::vector<std::string>& files) {
  std::vector<std::unique_ptr<CellSource>> members;
  for (const std::string& file : files) members.push_back(std::make_unique<StoredCells>(stored, file));
  return {std::move(members), repeating_starts(study, sweep)};
}

}  // namespace gust
