#include "gust/study/summary/margin_data.h"

#include <algorithm>

#include "gust/core/text.h"
#include "gust/study/trials/margin_trial.h"
#include "gust/study/trials/member_rows.h"
#include "gust/study/trials/trial_check.h"

namespace gust {
namespace {

/// The evaluations of a policy undisturbed or along a sweep, of these members or of all.
TrialGroup group_of(const Plan& plan, std::size_t policy, std::size_t sweep, std::span<const std::size_t> members) {
  TrialGroup found{policy, sweep, {}};
  for (const TrialGroup& group : trial_groups(plan)) {
    if (group.policy == policy && group.sweep == sweep) found = group;
  }
  std::erase_if(found.trials, [&](std::size_t trial) {
    return !members.empty() && std::ranges::find(members, plan.trials[trial].member) == members.end();
  });
  return found;
}

}  // namespace

Rng comparison_stream(const Study& study) { return Rng(static_cast<std::uint64_t>(study.seed)).split("compare"); }

std::shared_ptr<const MarginData> MarginReader::read(const SweepOf& of, const std::string& metric,
                                                     std::span<const std::size_t> members) const {
  std::vector<std::string> missing;
  MemberRows nominal(plan, group_of(plan, of.policy, Trial::kNominal, members), store, missing);
  MemberRows swept(plan, group_of(plan, of.policy, of.sweep, members), store, missing);
  if (nominal.members() == 0 || swept.members() != nominal.members() || !nominal.next()) return nullptr;
  if (!nominal.has(metric) || !swept.has(metric)) return nullptr;

  const Sweep& sweep = study.sweeps[of.sweep];
  const bool repeats = episodes_repeat(study, of.sweep, of.start);
  auto data = std::make_shared<MarginData>();
  data->policy = study.policies[of.policy].name;
  data->measured = cat(study.name, "/", sweep.name, "/", study.starts[of.start].name, "/", metric);
  data->rng = comparison_stream(study);
  data->undisturbed = nominal.values(of.start, metric, repeats);
  const std::vector<double>& levels = sweep.axes.front().values;
  for (std::size_t cell = 0; cell < levels.size() && swept.next(); ++cell)
    data->add(levels[cell], swept.values(of.start, metric, repeats));
  const bool nothing_else = sweep.disturbed.empty() && sweep.parameters.empty();
  if (nothing_else) data->add(0.0, data->undisturbed);

  for (const Trial& trial : plan.trials) {
    if (trial.kind != Trial::Kind::kMargin || trial.policy != of.policy || trial.sweep != of.sweep) continue;
    const std::optional<StoredTrial> stored = load_trial(plan, trial, store);
    if (!stored || trial.inputs.size() != 2 * nominal.members()) continue;  // it is that of other members
    for_each_margin_level(*stored, [&](double level, const MemberRows& rows) {
      if (rows.has(metric)) data->add(level, rows.values(of.start, metric, repeats));
    });
  }
  return data;
}

}  // namespace gust
