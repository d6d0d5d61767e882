#include "gust/study/summary/margin_data.h"

#include <algorithm>

#include "gust/core/text.h"

namespace gust {
namespace {

/// The rows of a policy undisturbed or along a sweep, of these members or of all.
MemberRows rows_of(const Measurements& measured, std::size_t policy, std::size_t sweep,
                   std::span<const std::size_t> members) {
  RowGroup group = measured.group(policy, sweep);
  std::erase_if(group.members, [&](std::size_t member) {
    return !members.empty() && std::ranges::find(members, member) == members.end();
  });
  std::vector<std::string> missing;
  return measured.rows(group, missing);
}

}  // namespace

Rng comparison_stream(const Study& study) { return Rng(static_cast<std::uint64_t>(study.seed)).split("compare"); }

std::shared_ptr<const MarginData> read_margin_data(const Measurements& measured, const SweepOf& of,
                                                   const std::string& metric, std::span<const std::size_t> members) {
  MemberRows nominal = rows_of(measured, of.policy, Trial::kNominal, members);
  MemberRows swept = rows_of(measured, of.policy, of.sweep, members);
  if (nominal.members() == 0 || swept.members() != nominal.members() || !nominal.next()) return nullptr;
  if (!nominal.has(metric) || !swept.has(metric)) return nullptr;

  const Study& study = measured.study();
  const Sweep& sweep = study.sweeps[of.sweep];
  auto data = std::make_shared<MarginData>();
  data->policy = study.policies[of.policy].name;
  data->measured = cat(study.name, "/", sweep.name, "/", study.starts[of.start].name, "/", metric);
  data->rng = comparison_stream(study);
  data->undisturbed = nominal.values(of.start, metric);
  const std::vector<double>& levels = sweep.axes.front().values;
  for (std::size_t cell = 0; cell < levels.size() && swept.next(); ++cell)
    data->add(levels[cell], swept.values(of.start, metric));
  const bool nothing_else = sweep.disturbed.empty() && sweep.parameters.empty();
  if (nothing_else) data->add(0.0, data->undisturbed);

  measured.for_each_added_level(of.policy, of.sweep, [&](double level, const MemberRows& rows) {
    if (rows.members() == nominal.members() && rows.has(metric)) data->add(level, rows.values(of.start, metric));
  });
  return data;
}

}  // namespace gust
