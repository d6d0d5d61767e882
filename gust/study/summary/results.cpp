#include "gust/study/summary/results.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gust/core/csv.h"

namespace gust {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// What stands in the column `metric` where it is none.
constexpr std::string_view kMargin = "margin";
constexpr std::string_view kMarginAtLeast = "margin_at_least";
constexpr std::string_view kMarginAtMost = "margin_at_most";
constexpr std::string_view kNoMargin = "no_margin";  // the column `over` says why
constexpr std::string_view kNotFinite = "not_finite";

// What stands in the column `over` of a line that is about one training alone.
constexpr std::string_view kOneTraining = "training";
constexpr std::string_view kDeviation = "deviation";  // of episodes

/// Nothing for what is not known.
std::string number_text(double value) { return std::isnan(value) ? std::string() : cat(value); }

std::string head_line() {
  return csv_line({"policy", "sweep", "start", "level", "level_2", "metric", "value", "low", "high", "n", "over"});
}

/// The lines of one series.
class SeriesLines {
 public:
  SeriesLines(const Study& study, const Series& series) : study_(study), series_(series) {}

  std::string text() const {
    std::string lines;
    for (std::size_t cell = 0; cell < series_.cells; ++cell) {
      for (const std::size_t metric : series_.metrics)
        lines += line(levels_of(cell), study_.metric_set.name(metric), series_.at(metric, cell));
    }
    for (std::size_t level = 0; level < series_.added_levels.size(); ++level) {
      for (const std::size_t metric : series_.metrics)
        lines += line({cat(series_.added_levels[level]), ""}, study_.metric_set.name(metric),
                      series_.at_added(metric, level));
    }
    for (const double value : series_.trainings) lines += training_line(value, kOneTraining);
    if (std::isfinite(series_.episode_deviation)) lines += training_line(series_.episode_deviation, kDeviation);
    if (series_.has_margin) lines += margin_line(series_.margin);
    if (series_.not_finite > 0) {
      const auto count = static_cast<double>(series_.not_finite);
      lines += line({}, std::string(kNotFinite), {count, kUnknown, kUnknown});
    }
    return lines;
  }

 private:
  const Sweep* sweep() const { return series_.sweep == Trial::kNominal ? nullptr : &study_.sweeps[series_.sweep]; }

  std::pair<std::string, std::string> levels_of(std::size_t cell) const {
    if (sweep() == nullptr) return {};
    const std::vector<double> at = sweep()->at(cell);
    return {cat(at[0]), at.size() == 1 ? "" : cat(at[1])};
  }

  std::string line(const std::pair<std::string, std::string>& levels, const std::string& metric,
                   const Estimate& estimate) const {
    return any_line(levels, metric, estimate, series_.units, unit_name(series_.unit));
  }

  std::string margin_line(const Margin& margin) const {
    const Interval& level = margin.level;
    if (std::isnan(level.estimate))
      return any_line({}, std::string(kNoMargin), {kUnknown, kUnknown, kUnknown}, 0, margin.reason);
    const std::string_view what = margin.censored ? kMarginAtLeast : margin.at_most ? kMarginAtMost : kMargin;
    return line({}, std::string(what), {level.estimate, level.low, level.high});
  }

  std::string training_line(double value, std::string_view over) const {
    const std::string metric = study_.metric_set.name(study_.metrics.front());
    return any_line(levels_of(0), metric, {value, kUnknown, kUnknown}, 1, over);
  }

  std::string any_line(const std::pair<std::string, std::string>& levels, const std::string& metric,
                       const Estimate& estimate, std::size_t units, std::string_view over) const {
    return csv_line({study_.policies[series_.policy].name, sweep() ? sweep()->name : "",
                     study_.starts[series_.start].name, levels.first, levels.second, metric,
                     number_text(estimate.value), number_text(estimate.low), number_text(estimate.high), cat(units),
                     std::string(over)});
  }

  const Study& study_;
  const Series& series_;
};

template <class Items>
std::size_t index_of(const Items& items, const std::string& name, const char* what, const std::string& place) {
  const auto at = std::ranges::find(items, name, &Items::value_type::name);
  if (at == items.end()) throw Error(cat(place, ": the study has no ", what, " '", name, "'"));
  return static_cast<std::size_t>(at - items.begin());
}

Unit unit_from(const std::string& name) {
  return name == unit_name(Unit::seeds) ? Unit::seeds : name == unit_name(Unit::episodes) ? Unit::episodes : Unit::none;
}

/// Puts the lines of cells_csv back together.
class CellReader {
 public:
  CellReader(const CsvTable& table, Study& study, Summary& summary) : table_(table), study_(study), summary_(summary) {}

  void read() {
    summary_.margin_metric = margin_metric(study_);
    find_levels();
    for (std::size_t i = 0; i < table_.size(); ++i) read_line(i);
  }

 private:
  std::size_t sweep_of(std::size_t line) const {
    const std::string& name = table_.text(line, "sweep");
    return name.empty() ? Trial::kNominal : index_of(study_.sweeps, name, "sweep", table_.place(line));
  }

  /// Automatic sweeps have the levels at which they were measured. Those that a margin asked for come behind them in
  /// the lines of a series, and begin again from below.
  void find_levels() {
    FoundLevels found;
    std::string series;
    double last = -1;
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const std::size_t sweep = sweep_of(i);
      if (sweep == Trial::kNominal || !study_.sweeps[sweep].automatic || table_.text(i, "level").empty()) continue;
      const std::string key = cat(sweep, "\n", table_.text(i, "policy"), "\n", table_.text(i, "start"));
      const double level = table_.number(i, "level");
      if (std::exchange(series, key) != key) last = -1;
      if (level < last) continue;
      last = level;
      std::vector<double>& levels = found[sweep];
      if (std::ranges::find(levels, level) == levels.end()) levels.push_back(level);
    }
    for (auto& [sweep, levels] : found) std::ranges::sort(levels);
    set_levels(study_, found);
  }

  Series& series_of(std::size_t line) {
    const std::size_t policy = index_of(study_.policies, table_.text(line, "policy"), "policy", table_.place(line));
    const std::size_t sweep = sweep_of(line);
    const std::size_t start = index_of(study_.starts, table_.text(line, "start"), "start", table_.place(line));
    if (!summary_.series.empty()) {  // lines of a series stand together
      Series& last = summary_.series.back();
      if (last.policy == policy && last.sweep == sweep && last.start == start) return last;
    }
    Series series{.policy = policy, .sweep = sweep, .start = start};
    series.cells = sweep == Trial::kNominal ? 1 : study_.sweeps[sweep].cells();
    series.metrics = summarised_metrics(study_);
    series.values.assign(series.metrics.size() * series.cells, {kUnknown, kUnknown, kUnknown});
    series.unit = unit_from(table_.text(line, "over"));
    series.units = table_.whole(line, "n");
    return summary_.series.emplace_back(std::move(series));
  }

  std::size_t cell_of(std::size_t line, std::size_t sweep) const {
    if (sweep == Trial::kNominal) return 0;
    const std::vector<Sweep::Axis>& axes = study_.sweeps[sweep].axes;
    std::size_t cell = 0;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const double level = table_.number(line, a == 0 ? "level" : "level_2");
      const auto at = std::ranges::find(axes[a].values, level);
      if (at == axes[a].values.end())
        throw Error(cat(table_.place(line), ": sweep '", study_.sweeps[sweep].name, "' has no ", axes[a].name(), " of ",
                        table_.text(line, a == 0 ? "level" : "level_2")));
      cell = cell * axes[a].values.size() + static_cast<std::size_t>(at - axes[a].values.begin());
    }
    return cell;
  }

  void read_line(std::size_t line) {
    Series& series = series_of(line);
    const Estimate estimate{table_.number(line, "value"), table_.number(line, "low"), table_.number(line, "high")};
    const std::string& metric = table_.text(line, "metric");
    if (metric == kMargin || metric == kMarginAtLeast || metric == kMarginAtMost || metric == kNoMargin) {
      read_margin(line, estimate, series);
      return;
    }
    if (metric == kNotFinite) {
      series.not_finite = table_.whole(line, "value");
      return;
    }
    const std::size_t index = study_.metric_set.index(metric, {table_.place(line)});
    const auto at = std::ranges::find(series.metrics, index);
    if (at == series.metrics.end())
      throw Error(cat(table_.place(line), ": the study does not lead with '", metric, "'"));
    if (table_.text(line, "over") == kOneTraining) {
      if (series.sweep == Trial::kNominal || series.cells != 1 || index != study_.metrics.front())
        throw Error(cat(table_.place(line), ": a training alone where the study keeps none"));
      series.trainings.push_back(estimate.value);
      return;
    }
    if (table_.text(line, "over") == kDeviation) {
      series.episode_deviation = estimate.value;
      return;
    }
    if (is_added(line, series.sweep)) {
      add(table_.number(line, "level"), static_cast<std::size_t>(at - series.metrics.begin()), estimate, series);
      return;
    }
    const auto row = static_cast<std::size_t>(at - series.metrics.begin());
    series.values[row * series.cells + cell_of(line, series.sweep)] = estimate;
  }

  void read_margin(std::size_t line, const Estimate& estimate, Series& series) const {
    if (series.sweep == Trial::kNominal || series.cells == 0)
      throw Error(cat(table_.place(line), ": a margin without levels to be found on"));
    const std::string& metric = table_.text(line, "metric");
    series.has_margin = true;
    if (metric == kNoMargin) {
      series.margin = no_margin(table_.text(line, "over"));
      return;
    }
    series.margin.level = {estimate.value, estimate.low, estimate.high, series.unit, series.units};
    series.margin.censored = metric == kMarginAtLeast;
    series.margin.at_most = metric == kMarginAtMost;
    series.margin.last_level = study_.sweeps[series.sweep].axes.front().values.back();
  }

  /// Whether a line is about a level that a margin asked for beside the sweep's own.
  bool is_added(std::size_t line, std::size_t sweep) const {
    if (sweep == Trial::kNominal || !study_.sweeps[sweep].along_levels()) return false;
    const std::vector<double>& levels = study_.sweeps[sweep].axes.front().values;
    const double level = table_.number(line, "level");
    return level < levels.back() && std::ranges::find(levels, level) == levels.end();
  }

  /// The lines of one added level stand together.
  static void add(double level, std::size_t row, const Estimate& estimate, Series& series) {
    if (std::ranges::find(series.added_levels, level) == series.added_levels.end())
      series.add_level(level, std::vector<Estimate>(series.metrics.size(), {kUnknown, kUnknown, kUnknown}));
    const auto at = std::ranges::find(series.added_levels, level) - series.added_levels.begin();
    series.added_values[row * series.added_levels.size() + static_cast<std::size_t>(at)] = estimate;
  }

  const CsvTable& table_;
  Study& study_;
  Summary& summary_;
};

}  // namespace

std::string cells_csv(const Study& study, const Summary& summary) {
  std::string text = head_line();
  for (const Series& series : summary.series) text += SeriesLines(study, series).text();
  return text;
}

std::string curves_csv(const Study& study, const Summary& summary) {
  std::vector<std::string> head = {"policy", "seed", "steps", "own_steps"};
  for (const CurveColumn& column : kCurveColumns) head.emplace_back(column.name);
  std::string text = csv_line(head);
  for (const SeedCurve& curve : summary.curves) {
    const StudyPolicy& policy = study.policies[curve.policy];
    for (const CurvePoint& point : curve.points) {
      std::vector<std::string> cells = {policy.name, policy.member(curve.member), cat(point.steps),
                                        cat(point.protagonist_steps)};
      for (const CurveColumn& column : kCurveColumns) cells.push_back(number_text(point.*column.value));
      text += csv_line(cells);
    }
  }
  return text;
}

void read_cells(std::string_view text, std::string_view name, Study& study, Summary& summary) {
  const CsvTable table(text, name);
  CellReader(table, study, summary).read();
}

void read_curves(std::string_view text, std::string_view name, const Study& study, Summary& summary) {
  const CsvTable table(text, name);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::size_t policy = index_of(study.policies, table.text(i, "policy"), "policy", table.place(i));
    std::size_t member = 0;
    while (member < study.policies[policy].count() && study.policies[policy].member(member) != table.text(i, "seed"))
      ++member;
    if (member == study.policies[policy].count())
      throw Error(
          cat(table.place(i), ": policy '", study.policies[policy].name, "' has no seed ", table.text(i, "seed")));
    if (summary.curves.empty() || summary.curves.back().policy != policy || summary.curves.back().member != member)
      summary.curves.push_back({policy, member, {}});
    CurvePoint point;
    point.steps = static_cast<std::int64_t>(table.whole(i, "steps"));
    point.protagonist_steps = static_cast<std::int64_t>(table.whole(i, "own_steps"));
    for (const CurveColumn& column : kCurveColumns) point.*column.value = table.number(i, column.name);
    summary.curves.back().points.push_back(point);
  }
}

}  // namespace gust
