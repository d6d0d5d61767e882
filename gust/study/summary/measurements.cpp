#include "gust/study/summary/measurements.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "gust/study/trials/margin_trial.h"
#include "gust/study/trials/policy_notes.h"
#include "gust/study/trials/trial_check.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

constexpr std::size_t kMostTraces = 60;  // about 3 MB of a page

std::vector<Trace> stored_traces_of(const StoredTrial& stored) {
  try {
    return read_traces(stored.read(kTracesFile), (stored.folder / kTracesFile).string());
  } catch (const Error& error) {
    throw Error(cat(error.what(), Store::remedy(stored.folder.parent_path().parent_path())));
  }
}

class StoredMeasurements final : public Measurements {
 public:
  StoredMeasurements(const Study& study, const Plan& plan, const Store& store)
      : Measurements(study), plan_(plan), store_(store) {
    for (const TrialGroup& trials : trial_groups(plan)) {
      RowGroup& group = groups_.emplace_back(trials.policy, trials.sweep);
      for (const std::size_t trial : trials.trials) {
        const std::size_t member = plan.trials[trial].member;
        group.members.push_back(member);
        evaluations_[{group.policy, group.sweep, member}] = trial;
      }
    }
  }

  const std::vector<RowGroup>& groups() const override { return groups_; }

  MemberRows rows(const RowGroup& group, std::vector<std::string>& missing) const override {
    TrialGroup trials{group.policy, group.sweep, {}};
    for (const std::size_t member : group.members) {
      if (const auto trial = evaluation(group.policy, group.sweep, member)) trials.trials.push_back(*trial);
    }
    return stored_rows(study(), plan_, trials, store_, missing);
  }

  bool has_rows(std::size_t policy, std::size_t sweep, std::size_t member) const override {
    const auto trial = evaluation(policy, sweep, member);
    return trial && store_.has(kind_name(Trial::Kind::kEvaluate), plan_.trials[*trial].id);
  }

  void for_each_added_level(std::size_t policy, std::size_t sweep,
                            const std::function<void(double, const MemberRows&)>& take) const override {
    const Trial* margin = margin_of(policy, sweep);
    if (margin == nullptr) return;
    const std::optional<StoredTrial> stored = load_trial(plan_, *margin, store_);
    if (stored) for_each_margin_level(study(), *margin, *stored, take);
  }

  std::vector<SeedCurve> curves() const override {
    std::vector<SeedCurve> curves;
    for (const Trial& trial : plan_.trials) {
      if (trial.kind != Trial::Kind::kTrain) continue;
      const std::optional<StoredTrial> stored = load_trial(plan_, trial, store_);
      if (stored) curves.push_back({trial.policy, trial.member, read_curve(stored->read(kCurveFile), kCurveFile)});
    }
    return curves;
  }

  std::optional<std::vector<CurvePoint>> curve(std::size_t policy, std::size_t member,
                                               std::vector<std::string>& missing) const override {
    const Trial* trial = training(policy, member);
    GUST_CHECK(trial != nullptr);
    const std::optional<StoredTrial> stored = load_trial(plan_, *trial, store_);
    if (stored) return read_curve(stored->read(kCurveFile), trial->id);
    missing.push_back(trial->what);
    return std::nullopt;
  }

  bool training_failed(std::size_t policy, std::size_t member) const override {
    const Trial* trial = training(policy, member);
    return trial != nullptr && training_failure(plan_, *trial, store_).has_value();
  }

  /// Evenly over the plan.
  std::vector<KeptTraces> kept() const override {
    std::vector<const Trial*> trials;
    for (const Trial& trial : plan_.trials) {
      if (trial.kind == Trial::Kind::kEvaluate && trial.member == 0) trials.push_back(&trial);
    }
    std::vector<KeptTraces> kept;
    const std::size_t each = std::max<std::size_t>(1, trials.empty() ? 1 : kMostTraces / trials.size());
    const std::size_t stride = std::max<std::size_t>(1, (trials.size() + kMostTraces - 1) / kMostTraces);
    for (std::size_t t = 0; t < trials.size(); t += stride) {
      const Trial& trial = *trials[t];
      const std::optional<StoredTrial> stored = load_trial(plan_, trial, store_);
      if (!stored) continue;
      std::vector<Trace> traces = stored_traces_of(*stored);
      if (traces.size() > each) traces.resize(each);
      if (!traces.empty()) kept.push_back({trial.policy, trial.member, trial.sweep, std::move(traces)});
    }
    return kept;
  }

  std::vector<std::string> missing(const std::vector<std::size_t>& policies) const override {
    if (policies.empty()) return missing_trials(plan_, store_);
    Plan theirs = plan_;
    std::erase_if(theirs.trials,
                  [&](const Trial& trial) { return std::ranges::find(policies, trial.policy) == policies.end(); });
    return missing_trials(theirs, store_);
  }

  std::vector<std::string> notes() const override { return policy_notes(study(), plan_, store_); }

 private:
  std::optional<std::size_t> evaluation(std::size_t policy, std::size_t sweep, std::size_t member) const {
    const auto found = evaluations_.find({policy, sweep, member});
    return found == evaluations_.end() ? std::nullopt : std::optional(found->second);
  }

  const Trial* margin_of(std::size_t policy, std::size_t sweep) const {
    const auto margin = std::ranges::find_if(plan_.trials, [&](const Trial& trial) {
      return trial.kind == Trial::Kind::kMargin && trial.policy == policy && trial.sweep == sweep;
    });
    return margin == plan_.trials.end() ? nullptr : &*margin;
  }

  const Trial* training(std::size_t policy, std::size_t member) const {
    const auto found = std::ranges::find_if(plan_.trials, [&](const Trial& trial) {
      return trial.kind == Trial::Kind::kTrain && trial.policy == policy && trial.member == member;
    });
    return found == plan_.trials.end() ? nullptr : &*found;
  }

  const Plan& plan_;
  const Store& store_;
  std::vector<RowGroup> groups_;
  std::map<std::tuple<std::size_t, std::size_t, std::size_t>, std::size_t> evaluations_;  // by policy, sweep, member
};

}  // namespace

RowGroup Measurements::group(std::size_t policy, std::size_t sweep) const {
  for (const RowGroup& group : groups()) {
    if (group.policy == policy && group.sweep == sweep) return group;
  }
  return {policy, sweep, {}};
}

std::unique_ptr<Measurements> stored_measurements(const Study& study, const Plan& plan, const Store& store) {
  return std::make_unique<StoredMeasurements>(study, plan, store);
}

}  // namespace gust
