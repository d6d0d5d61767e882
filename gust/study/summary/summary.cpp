#include "gust/study/summary/summary.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "gust/core/crew.h"
#include "gust/stats/aggregate.h"
#include "gust/stats/share.h"
#include "gust/study/summary/claim_scores.h"
#include "gust/study/trials/margin_trial.h"

namespace gust {
namespace {

constexpr std::size_t kBandResamples = 2'000;  // of each cell's interval

Rng resampling_stream(const Study& study) { return Rng(static_cast<std::uint64_t>(study.seed)).split("bootstrap"); }

/// What one thread needs to summarise group after group.
class Summariser {
 public:
  Summariser(const Measurements& measured, std::size_t margin_metric)
      : measured_(measured),
        study_(measured.study()),
        metrics_(summarised_metrics(study_)),
        margin_metric_(margin_metric),
        survival_(study_.metric_set.first(MetricRole::survival)),
        bands_(resampling_stream(study_), kBandResamples) {}

  std::vector<Series> summarise(const RowGroup& group) {
    std::vector<Series> series;
    std::vector<std::string> missing;
    MemberRows rows = measured_.rows(group, missing);
    if (rows.members() == 0) return series;
    const std::size_t starts = rows.header().starts.size();
    for (std::size_t start = 0; start < starts; ++start) series.push_back(empty_series(group, start, rows.header()));
    MarginScores scores(study_, group.sweep);
    const bool with_margin =
        has_margin(group) && rows.has(study_.metric_set.name(margin_metric_)) && take_undisturbed(group, scores);
    for (std::size_t cell = 0; rows.next(); ++cell) {
      for (std::size_t start = 0; start < starts; ++start) {
        fill_cell(rows, cell, series[start]);
      }
      if (with_margin) scores.take(study_.sweeps[group.sweep].axes.front().values[cell], rows);
    }
    if (with_margin) add_levels(group, scores, series);
    for (std::size_t start = 0; start < starts && with_margin; ++start) {
      series[start].margin = scores.margin(start);
      series[start].has_margin = true;
    }
    return series;
  }

 private:
  bool has_margin(const RowGroup& group) const {
    if (group.sweep == Trial::kNominal) return false;
    const Sweep& sweep = study_.sweeps[group.sweep];
    return sweep.along_levels() && sweep.axes.front().values.size() > 1;
  }

  /// False where undisturbed rows are missing: then no margin can be told.
  bool take_undisturbed(const RowGroup& group, MarginScores& scores) const {
    RowGroup nominal = measured_.group(group.policy, Trial::kNominal);
    std::erase_if(nominal.members, [&](std::size_t member) {
      const bool asked = std::ranges::find(group.members, member) != group.members.end();
      return !asked || !measured_.has_rows(group.policy, group.sweep, member);
    });
    std::vector<std::string> missing;
    MemberRows rows = measured_.rows(nominal, missing);
    if (rows.members() == 0 || !missing.empty()) return false;
    scores.take_undisturbed(std::move(rows));
    return true;
  }

  /// What was measured beside the sweep's own levels.
  void add_levels(const RowGroup& group, MarginScores& scores, std::vector<Series>& parts) {
    measured_.for_each_added_level(group.policy, group.sweep, [&](double level, const MemberRows& rows) {
      for (Series& series : parts) series.add_level(level, estimates(rows, series));
      scores.take(level, rows);
    });
  }

  Series empty_series(const RowGroup& group, std::size_t start, const RowsHeader& header) const {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    Series series{.policy = group.policy, .sweep = group.sweep, .start = start};
    series.cells = static_cast<std::size_t>(header.cells);
    series.metrics = metrics_;
    series.values.assign(metrics_.size() * series.cells, {kUnknown, kUnknown, kUnknown});
    return series;
  }

  void fill_cell(const MemberRows& rows, std::size_t cell, Series& series) {
    const std::vector<Estimate> found = estimates(rows, series);
    for (std::size_t i = 0; i < metrics_.size(); ++i) series.values[i * series.cells + cell] = found[i];
  }

  /// An interval for what the page leads with, the mean alone for the rest; what was not measured stays unknown.
  std::vector<Estimate> estimates(const MemberRows& rows, Series& series) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    std::vector<Estimate> found(metrics_.size(), {kUnknown, kUnknown, kUnknown});
    for (std::size_t i = 0; i < metrics_.size(); ++i) {
      const std::size_t metric = metrics_[i];
      const std::string& name = study_.metric_set.name(metric);
      if (!rows.has(name)) continue;
      const Matrix<double> values = rows.values(series.start, name);
      const bool leads = std::ranges::find(study_.metrics, metric) != study_.metrics.end() || metric == survival_;
      const Interval result = leads ? measure(values, metric, bands_) : Interval{.estimate = mean_of(values)};
      found[i] = {result.estimate, result.low, result.high};
      const bool alone = series.cells == 1 && series.sweep != Trial::kNominal;
      if (alone && metric == study_.metrics.front()) {
        if (result.unit == Unit::seeds) series.trainings = unit_values(values.view());
        series.episode_deviation = episode_deviation(values);
      }
      if (metric == margin_metric_) {
        for (std::size_t m = 0; m < values.rows(); ++m) {
          series.not_finite += static_cast<std::size_t>(
              std::ranges::count_if(values.row(m), [](double v) { return !std::isfinite(v); }));
        }
      }
      series.unit = unit_of(values.view());
      series.units = series.unit == Unit::seeds ? values.rows() : values.lanes();
    }
    return found;
  }

  static double episode_deviation(const Matrix<double>& values) {
    if (values.lanes() < 2) return std::numeric_limits<double>::quiet_NaN();
    double sum = 0;
    for (std::size_t m = 0; m < values.rows(); ++m) {
      double mean = 0, squares = 0;
      for (const double value : values.row(m)) mean += value / static_cast<double>(values.lanes());
      for (const double value : values.row(m)) squares += (value - mean) * (value - mean);
      sum += std::sqrt(squares / static_cast<double>(values.lanes() - 1));
    }
    return sum / static_cast<double>(values.rows());
  }

  static double mean_of(const Matrix<double>& values) {
    double sum = 0;
    for (std::size_t m = 0; m < values.rows(); ++m) {
      for (const double value : values.row(m)) sum += value;
    }
    return sum / static_cast<double>(values.rows() * values.lanes());
  }

  Interval measure(const Matrix<double>& values, std::size_t metric, Bootstrap& bootstrap) const {
    if (study_.metric_set[metric].traits().zero_or_one) return share_interval(values.view(), bootstrap);
    return interval(values.view(), Statistic::mean, bootstrap);
  }

  const Measurements& measured_;
  const Study& study_;
  std::vector<std::size_t> metrics_;
  std::size_t margin_metric_;
  std::optional<std::size_t> survival_;
  Bootstrap bands_;
};

/// Both ways of saying a claim ask the same scores, so one statement has one interval and one verdict.
Finding judged(const Study& study, const StudyClaim& claim, const ClaimScores& scores) {
  if (claim.formula) return judge(*claim.formula, study.names, scores);
  std::vector<std::string> metrics;
  for (std::size_t i = 0; i < study.metric_set.size(); ++i) metrics.push_back(study.metric_set.name(i));
  const Claim bound = parse_claim(claim.holds, metrics, claim.place);
  scores.fewest_seeds();  // of the claim before
  try {
    const Sampled measured = scores.measured(bound.metric, claim.policy, claim.sweep, claim.at);
    return judge(bound, measured, scores.fewest_seeds());
  } catch (const NotTestable& missing) {
    return {.verdict = {Ruling::not_testable, missing.what()}};
  }
}

void judge_claims(const Measurements& measured, std::vector<ClaimVerdict>& verdicts) {
  const Study& study = measured.study();
  std::map<std::pair<std::string, std::string>, ClaimScores> views;  // each reads a sweep once
  for (const StudyClaim& claim : study.claims) {
    const ClaimView view{claim.metric, claim.start};
    const std::vector<ClaimSource> sources = {{&study, &measured}};
    const auto at = views.try_emplace({view.metric, view.start}, sources, view, resampling_stream(study)).first;
    verdicts.push_back({&claim, judged(study, claim, at->second)});
  }
}

}  // namespace

std::size_t Series::row_of(std::size_t metric) const {
  const auto place = std::ranges::find(metrics, metric);
  GUST_CHECK(place != metrics.end());
  return static_cast<std::size_t>(place - metrics.begin());
}

const Estimate& Series::at(std::size_t metric, std::size_t cell) const { return values[row_of(metric) * cells + cell]; }

const Estimate& Series::at_added(std::size_t metric, std::size_t level) const {
  return added_values[row_of(metric) * added_levels.size() + level];
}

void Series::add_level(double level, const std::vector<Estimate>& estimates) {
  const auto at = std::ranges::lower_bound(added_levels, level) - added_levels.begin();
  added_levels.insert(added_levels.begin() + at, level);
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const auto place = static_cast<std::ptrdiff_t>(i * added_levels.size()) + at;
    added_values.insert(added_values.begin() + place, estimates[i]);
  }
}

std::vector<std::size_t> summarised_metrics(const Study& study) {
  std::vector<std::size_t> metrics = study.metrics;
  const std::optional<std::size_t> more[] = {study.metric_set.first(MetricRole::survival),
                                             study.metric_set.first(MetricRole::saturation), margin_metric(study)};
  for (const std::optional<std::size_t>& metric : more) {
    if (metric && std::ranges::find(metrics, *metric) == metrics.end()) metrics.push_back(*metric);
  }
  return metrics;
}

const Series* Summary::find(std::size_t policy, std::size_t sweep, std::size_t start) const {
  for (const Series& item : series) {
    if (item.policy == policy && item.sweep == sweep && item.start == start) return &item;
  }
  return nullptr;
}

double Summary::undisturbed(std::size_t policy, std::size_t start) const {
  const Series* nominal = find(policy, Trial::kNominal, start);
  return nominal ? nominal->at(margin_metric, 0).value : std::numeric_limits<double>::quiet_NaN();
}

Summary summarise(const Measurements& measured, std::size_t threads) {
  const std::vector<RowGroup> groups = measured.groups();
  Summary summary;
  summary.margin_metric = margin_metric(measured.study());
  std::vector<std::vector<Series>> parts(groups.size());
  for_each_item(threads, groups.size(), [&] {
    auto summariser = std::make_shared<Summariser>(measured, summary.margin_metric);
    return [&, summariser](std::size_t i) { parts[i] = summariser->summarise(groups[i]); };
  });
  for (std::vector<Series>& part : parts) std::ranges::move(part, std::back_inserter(summary.series));
  summary.missing = measured.missing();
  summary.curves = measured.curves();
  summary.kept = measured.kept();
  summary.notes = measured.notes();
  judge_claims(measured, summary.claims);
  return summary;
}

}  // namespace gust
