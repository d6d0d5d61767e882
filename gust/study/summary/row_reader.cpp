#include "gust/study/summary/row_reader.h"

#include <cmath>
#include <tuple>

#include "gust/core/csv.h"
#include "gust/core/text.h"
#include "gust/study/summary/export.h"

namespace gust {
namespace {

/// Reads the lines of a table and sorts them by policy, sweep, member and level.
class RowReader {
 public:
  RowReader(std::string_view text, std::string_view name, const Study& study) : csv_(text, name), study_(study) {
    for (const char* column : {"policy", "metric", "value"}) csv_.column(column);
    for (const char* column : {"plant", "preset", "readings", "site", "channels", "waveform", "window", "vary"}) {
      if (const auto at = csv_.find_column(column)) described_.push_back({column, *at});
    }
  }

  std::map<RowKey, GroupRows> read() {
    std::map<RowKey, GroupRows> groups;
    while (csv_.next()) {
      const std::size_t policy = named("policy", study_.policies, &StudyPolicy::name);
      const std::size_t sweep = sweep_of_row();
      const std::size_t member = member_of_row(study_.policies[policy]);
      check_description(policy, member, sweep);
      TableRow row{csv_.line(), named("start", study_.starts, &StartProtocol::name), metric_of_row(), 0, 0};
      if (const auto episode = csv_.find_column("episode")) row.episode = csv_.whole(*episode);
      row.value = csv_.number(csv_.column("value"));
      groups[{policy, sweep}][member][level_of_row(sweep)].push_back(row);
    }
    if (groups.empty()) throw Error(cat(csv_.place(), ": the table has no rows"));
    return groups;
  }

 private:
  std::string cell(std::string_view column) const {
    const auto at = csv_.find_column(column);
    return at ? csv_.text(*at) : std::string();
  }

  /// The position of the item that a cell names; the only one there is where no cell names it.
  template <class Items, class Name>
  std::size_t named(std::string_view column, const Items& items, Name name) const {
    const std::string wanted = cell(column);
    if (wanted.empty() && items.size() == 1) return 0;
    std::vector<std::string> known;
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (items[i].*name == wanted) return i;
      known.push_back(items[i].*name);
    }
    throw Error(cat(csv_.place(), ": the study has no ", column, " '", wanted, "'", did_you_mean(wanted, known),
                    "; it has ", join(known, ", ")));
  }

  std::size_t sweep_of_row() const {
    const std::string sweep = cell("sweep");
    return sweep.empty() || sweep == "none" ? Trial::kNominal : named("sweep", study_.sweeps, &Sweep::name);
  }

  std::size_t member_of_row(const StudyPolicy& policy) const {
    const std::string wanted = cell("seed");
    if (wanted.empty() && policy.count() == 1) return 0;
    std::vector<std::string> known;
    for (std::size_t member = 0; member < policy.count(); ++member) {
      known.push_back(policy.member(member));
      if (known.back() == wanted) return member;
    }
    throw Error(
        cat(csv_.place(), ": policy '", policy.name, "' has no seed '", wanted, "'", did_you_mean(wanted, known)));
  }

  std::size_t metric_of_row() const {
    const std::size_t metric = study_.metric_set.index(cell("metric"), {csv_.place()});
    if (!study_.metric_set[metric].quotient()) return metric;
    throw Error(cat(csv_.place(), ": '", cell("metric"), "' is a quotient of means; give the two that it divides"));
  }

  RowLevel level_of_row(std::size_t sweep) const {
    if (sweep == Trial::kNominal) return {};
    const bool grid = study_.sweeps[sweep].axes.size() == 2;
    RowLevel level{csv_.number(csv_.column("level"))};
    if (grid) level.second = csv_.number(csv_.column("level_2"));
    if (std::isfinite(level.value) && std::isfinite(level.second.value_or(0))) return level;
    throw Error(cat(csv_.place(), ": a row of sweep '", study_.sweeps[sweep].name, "' needs a level",
                    grid ? " and a level_2" : ""));
  }

  /// What a row says beside its numbers must be what the study says.
  void check_description(std::size_t policy, std::size_t member, std::size_t sweep) {
    if (described_.empty()) return;
    const auto [at, is_new] = heads_.try_emplace({policy, member, sweep});
    if (is_new) at->second = export_head(study_, policy, member, sweep);
    const ExportRow& head = at->second;
    const std::map<std::string_view, const std::string*> of_study = {
        {"plant", &head.plant},       {"preset", &head.preset},     {"readings", &head.readings}, {"site", &head.site},
        {"channels", &head.channels}, {"waveform", &head.waveform}, {"window", &head.window},     {"vary", &head.vary}};
    for (const auto& [column, index] : described_) {
      const std::string& said = csv_.text(index);
      if (!said.empty() && said != *of_study.at(column))
        throw Error(
            cat(csv_.place(), ": ", column, " is '", said, "', where the study has '", *of_study.at(column), "'"));
    }
  }

  CsvReader csv_;
  const Study& study_;
  std::vector<std::pair<std::string_view, std::size_t>> described_;  // columns
  std::map<std::tuple<std::size_t, std::size_t, std::size_t>, ExportRow> heads_;
};

}  // namespace

std::string text_of(const RowLevel& level) {
  return level.second ? cat(level.value, ", ", *level.second) : cat(level.value);
}

std::map<RowKey, GroupRows> read_table_rows(std::string_view text, std::string_view name, const Study& study) {
  return RowReader(text, name, study).read();
}

}  // namespace gust
