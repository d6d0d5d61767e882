#include "gust/study/summary/row_table.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "gust/study/summary/row_reader.h"

namespace gust {
namespace {

/// Cells in the layout of rows files (RowsHeader).
struct Cells {
  RowsHeader header;
  std::vector<double> values;
};

class HeldCells final : public CellSource {
 public:
  HeldCells(const Cells& cells, std::size_t first, std::size_t count)
      : cells_(cells), next_(first), end_(first + count) {}
  const RowsHeader& header() const override { return cells_.header; }
  std::span<const double> next() override {
    if (next_ == end_) return {};
    const std::size_t size = cells_.header.cell_size();
    return std::span(cells_.values).subspan(size * next_++, size);
  }

 private:
  const Cells& cells_;
  std::size_t next_, end_;
};

/// What was measured of a policy along a sweep.
struct MeasuredGroup {
  std::map<std::size_t, Cells> members;  ///< the study's cells, then those at added levels
  std::size_t cells = 0;                 ///< of the study
  std::vector<double> added_levels;
  std::vector<bool> repeats;  ///< by start
};

/// Puts the rows of one policy along a sweep into cells.
class GroupBuilder {
 public:
  GroupBuilder(const Study& study, std::string_view name, const RowKey& key, const GroupRows& rows)
      : study_(study), name_(name), key_(key), rows_(rows) {}

  MeasuredGroup build() {
    find_levels();
    find_sizes();
    for (const auto& [member, levels] : rows_) fill(member, levels);
    for (std::size_t start = 0; start < study_.starts.size(); ++start)
      group_.repeats.push_back(episodes_repeat(study_, key_.sweep, start) && are_equal(start));
    return std::move(group_);
  }

 private:
  std::string what() const {
    const std::string sweep = key_.sweep == Trial::kNominal ? "undisturbed" : study_.sweeps[key_.sweep].name;
    return cat("policy '", study_.policies[key_.policy].name, "', ", sweep);
  }

  std::string member_text(std::size_t member) const {
    const std::string name = study_.policies[key_.policy].member(member);
    return name.empty() ? what() : cat(what(), ", seed ", name);
  }

  /// The study's levels first, in the order of its cells, then those beside them.
  void find_levels() {
    const Sweep* sweep = key_.sweep == Trial::kNominal ? nullptr : &study_.sweeps[key_.sweep];
    if (sweep == nullptr) levels_ = {RowLevel{}};
    for (std::size_t cell = 0; sweep != nullptr && cell < sweep->cells(); ++cell) {
      const std::vector<double> at = sweep->at(cell);
      levels_.push_back({at[0], at.size() == 2 ? std::optional(at[1]) : std::nullopt});
    }
    group_.cells = levels_.size();
    for (const auto& [level, rows] : rows_.begin()->second) {
      if (std::ranges::find(levels_, level) != levels_.end()) continue;
      if (key_.sweep == Trial::kNominal || !study_.sweeps[key_.sweep].along_levels())
        throw Error(cat(name_, ":", rows.front().line, ": the sweep has no ", text_of(level)));
      levels_.push_back(level);
      group_.added_levels.push_back(level.value);
    }
    for (const auto& [member, levels] : rows_) {
      for (const RowLevel& level : levels_) {
        if (!levels.contains(level))
          throw Error(cat(name_, ": ", member_text(member), ": no rows at level ", text_of(level)));
      }
      for (const auto& [level, rows] : levels) {
        if (std::ranges::find(levels_, level) == levels_.end())
          throw Error(cat(name_, ":", rows.front().line, ": level ", text_of(level),
                          " was measured of this seed and not of all"));
      }
    }
  }

  /// How many episodes there are, and of which metrics: the same for all members and levels.
  void find_sizes() {
    std::set<std::size_t> metrics;
    std::uint64_t episodes = 0;
    for (const auto& [member, levels] : rows_) {
      for (const auto& [level, rows] : levels) {
        for (const TableRow& row : rows) {
          metrics.insert(row.metric);
          episodes = std::max(episodes, row.episode + 1);
        }
      }
    }
    metrics_.assign(metrics.begin(), metrics.end());
    for (const std::size_t metric : metrics_) header_.metrics.push_back(study_.metric_set.name(metric));
    for (const StartProtocol& start : study_.starts) header_.starts.push_back(start.name);
    header_.episodes = episodes;
    header_.cells = group_.cells;
    const std::string problem = complaint(header_);
    if (!problem.empty()) throw Error(cat(name_, ": ", what(), ": ", problem));
  }

  void fill(std::size_t member, const MemberLevels& levels) {
    Cells& cells = group_.members[member];
    cells.header = header_;
    const std::size_t size = header_.cell_size();
    const std::size_t stride = metrics_.size();
    const auto episodes = static_cast<std::size_t>(header_.episodes);
    cells.values.assign(levels_.size() * size, 0.0);
    std::vector<std::size_t> lines(size);
    for (std::size_t cell = 0; cell < levels_.size(); ++cell) {
      std::ranges::fill(lines, 0);
      for (const TableRow& row : levels.at(levels_[cell])) {
        const auto column = static_cast<std::size_t>(std::ranges::find(metrics_, row.metric) - metrics_.begin());
        const std::size_t place = (row.start * episodes + static_cast<std::size_t>(row.episode)) * stride + column;
        if (lines[place] > 0) throw Error(cat(name_, ":", row.line, ": the row of line ", lines[place], " once more"));
        lines[place] = row.line;
        cells.values[cell * size + place] = row.value;
      }
      const auto gap = static_cast<std::size_t>(std::ranges::find(lines, std::size_t{0}) - lines.begin());
      if (gap == size) continue;
      const std::size_t episode = gap / stride;
      throw Error(cat(name_, ": ", member_text(member), ", level ", text_of(levels_[cell]), ", start '",
                      header_.starts[episode / episodes], "': episode ", episode % episodes, " has no '",
                      header_.metrics[gap % stride], "'"));
    }
  }

  /// Whether all episodes from a start have the same numbers, in every cell.
  bool are_equal(std::size_t start) const {
    const std::size_t stride = metrics_.size();
    const std::size_t length = stride * static_cast<std::size_t>(header_.episodes);
    for (const auto& [member, cells] : group_.members) {
      for (std::size_t cell = 0; cell < levels_.size(); ++cell) {
        const std::span<const double> all =
            std::span(cells.values).subspan(cell * header_.cell_size() + start * length, length);
        for (std::size_t i = stride; i < all.size(); ++i) {
          const double first = all[i % stride];
          if (all[i] != first && !(std::isnan(all[i]) && std::isnan(first))) return false;
        }
      }
    }
    return true;
  }

  const Study& study_;
  std::string_view name_;
  RowKey key_;
  const GroupRows& rows_;
  std::vector<RowLevel> levels_;
  std::vector<std::size_t> metrics_;
  RowsHeader header_;
  MeasuredGroup group_;
};

class RowTable final : public Measurements {
 public:
  RowTable(const Study& study, std::map<RowKey, MeasuredGroup> measured)
      : Measurements(study), measured_(std::move(measured)) {
    for (std::size_t policy = 0; policy < study.policies.size(); ++policy) {
      std::vector<std::size_t> members(study.policies[policy].count());
      for (std::size_t member = 0; member < members.size(); ++member) members[member] = member;
      groups_.push_back({policy, Trial::kNominal, members});
      for (std::size_t sweep = 0; sweep < study.sweeps.size(); ++sweep) groups_.push_back({policy, sweep, members});
    }
  }

  const std::vector<RowGroup>& groups() const override { return groups_; }

  MemberRows rows(const RowGroup& group, std::vector<std::string>& missing) const override {
    std::vector<std::unique_ptr<CellSource>> members;
    const MeasuredGroup* measured = find(group.policy, group.sweep);
    for (const std::size_t member : group.members) {
      const Cells* cells = find(group.policy, group.sweep, member);
      if (cells) members.push_back(std::make_unique<HeldCells>(*cells, 0, measured->cells));
      if (!cells) missing.push_back(name_of(group.policy, group.sweep, member));
    }
    return {std::move(members), measured ? measured->repeats : std::vector<bool>(study().starts.size())};
  }

  bool has_rows(std::size_t policy, std::size_t sweep, std::size_t member) const override {
    return find(policy, sweep, member) != nullptr;
  }

  void for_each_added_level(std::size_t policy, std::size_t sweep,
                            const std::function<void(double, const MemberRows&)>& take) const override {
    const MeasuredGroup* group = find(policy, sweep);
    for (std::size_t i = 0; group != nullptr && i < group->added_levels.size(); ++i) {
      std::vector<std::unique_ptr<CellSource>> members;
      for (const auto& [member, cells] : group->members)
        members.push_back(std::make_unique<HeldCells>(cells, group->cells + i, 1));
      MemberRows rows(std::move(members), group->repeats);
      rows.next();
      take(group->added_levels[i], rows);
    }
  }

  std::vector<SeedCurve> curves() const override { return {}; }
  std::optional<std::vector<CurvePoint>> curve(std::size_t policy, std::size_t member,
                                               std::vector<std::string>& missing) const override {
    missing.push_back(cat("the learning curve of ", label(policy, member)));
    return std::nullopt;
  }
  bool training_failed(std::size_t, std::size_t) const override { return false; }
  std::vector<KeptTraces> kept() const override { return {}; }

  std::vector<std::string> missing(const std::vector<std::size_t>& policies) const override {
    std::vector<std::string> missing;
    for (const RowGroup& group : groups_) {
      if (!policies.empty() && std::ranges::find(policies, group.policy) == policies.end()) continue;
      for (const std::size_t member : group.members) {
        if (find(group.policy, group.sweep, member) == nullptr)
          missing.push_back(name_of(group.policy, group.sweep, member));
      }
    }
    return missing;
  }
  std::vector<std::string> notes() const override { return {}; }

 private:
  const MeasuredGroup* find(std::size_t policy, std::size_t sweep) const {
    const auto found = measured_.find({policy, sweep});
    return found == measured_.end() ? nullptr : &found->second;
  }
  const Cells* find(std::size_t policy, std::size_t sweep, std::size_t member) const {
    const MeasuredGroup* group = find(policy, sweep);
    if (group == nullptr) return nullptr;
    const auto found = group->members.find(member);
    return found == group->members.end() ? nullptr : &found->second;
  }

  std::string label(std::size_t policy, std::size_t member) const {
    const StudyPolicy& of = study().policies[policy];
    return of.member(member).empty() ? of.name : cat(of.name, " seed ", of.member(member));
  }
  std::string name_of(std::size_t policy, std::size_t sweep, std::size_t member) const {
    return cat(label(policy, member), " · ", sweep == Trial::kNominal ? "nominal" : study().sweeps[sweep].name);
  }

  std::map<RowKey, MeasuredGroup> measured_;
  std::vector<RowGroup> groups_;
};

/// The levels at which every policy and seed was measured that was measured along the sweep at all.
std::vector<double> common_levels(const std::map<RowKey, GroupRows>& groups, std::size_t sweep) {
  std::map<double, std::size_t> counts;
  std::size_t members = 0;
  for (const auto& [key, rows] : groups) {
    if (key.sweep != sweep) continue;
    for (const auto& [member, levels] : rows) {
      ++members;
      for (const auto& [level, unused] : levels) ++counts[level.value];
    }
  }
  std::vector<double> common;
  for (const auto& [level, count] : counts) {
    if (count == members) common.push_back(level);
  }
  return common;
}

}  // namespace

std::unique_ptr<Measurements> read_row_table(std::string_view text, std::string_view name, Study& study) {
  const std::map<RowKey, GroupRows> rows = read_table_rows(text, name, study);
  FoundLevels found;
  for (std::size_t sweep = 0; sweep < study.sweeps.size(); ++sweep) {
    if (study.sweeps[sweep].automatic) found[sweep] = common_levels(rows, sweep);
  }
  set_levels(study, found);
  std::map<RowKey, MeasuredGroup> measured;
  for (const auto& [key, group] : rows) measured.emplace(key, GroupBuilder(study, name, key, group).build());
  return std::make_unique<RowTable>(study, std::move(measured));
}

}  // namespace gust
