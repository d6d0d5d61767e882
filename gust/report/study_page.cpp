#include "gust/report/study_page.h"

#include <algorithm>
#include <cmath>

#include "gust/core/text.h"
#include "gust/report/study_episodes.h"
#include "gust/study/text/warnings.h"

namespace gust {
namespace {

/// "lqr", "train ppo": what the reader should know it as.
std::string kind_text(const StudyPolicy& policy) {
  return policy.training() ? cat(policy.kind, " ", policy.training()->agent.kind) : policy.kind;
}

Page::Metric page_metric(const std::string& name, const MetricTraits& traits, const Interface& spec) {
  const std::string unit = traits.unit.empty() ? "" : cat(" [", traits.unit, "]");
  const Limits axis = axis_of(traits, spec);
  return {name, cat(traits.title, unit), metrics().at(name).summary, axis.low, axis.high};
}

/// What names a cell to `gust eval --study`.
std::string cell_text(const std::string& sweep, const std::string& level) {
  return cat(" --sweep ", shell_word(sweep), " --level ", level);
}

std::string middle_of(const Sweep& sweep) {
  std::vector<std::string> level;
  for (const Sweep::Axis& axis : sweep.axes) level.push_back(cat(axis.values[axis.values.size() / 2]));
  return cell_text(sweep.name, join(level, ","));
}

Page::Sweep page_sweep(const Study& study, const Sweep& sweep) {
  const Interface& spec = study.setup.plant->spec();
  Page::Sweep page;
  page.name = sweep.name;
  page.levels = sweep.axes.front().values;
  page.unit = sweep.unit(spec);
  if (sweep.injection) {
    page.site = site_name(sweep.injection->site);
    page.waveform = sweep.injection->kind();
  } else {
    const Parameter& parameter = spec.parameters[sweep.axes.front().index];
    page.waveform = parameter.name;
    page.nominal = parameter.nominal;
    const Limits possible = possible_values(study.setup, sweep.axes.front().index);
    if (std::isfinite(possible.low)) page.possible_low = possible.low;
    if (std::isfinite(possible.high)) page.possible_high = possible.high;
  }
  return page;
}

/// A column of learning curves that the page shows.
struct LearningScore {
  const char* title;
  double CurvePoint::*column;
};

/// Writes a study into a page, part by part. Sweeps over two parameters become grids; the others keep their order, and
/// `sweep_at` says where each one stands.
class PageWriter {
 public:
  PageWriter(const Study& study, const Summary& summary)
      : study_(study), summary_(summary), sweep_at_(study.sweeps.size(), Page::kNone) {}

  Page write(const PageContext& context) {
    folder_ = context.folder;
    head(context);
    lists();
    for (const Series& series : summary_.series) {
      if (series.sweep == Trial::kNominal) continue;
      study_.sweeps[series.sweep].axes.size() == 2 ? grid(series) : curves(series);
    }
    for (const SweepComparison& item : context.comparisons) compared(item);
    claims();
    learning();
    page_.episodes = kept_episodes(study_, summary_.kept, sweep_at_);
    for (Page::Episode& episode : page_.episodes) {
      if (episode.sweep == Page::kNone) continue;
      const std::string where = cell_text(page_.sweeps[episode.sweep].name, cat(episode.level));
      episode.command = cell_command(episode.policy, episode.start, where);
    }
    link_margins();
    order_starts(context.start);
    return std::move(page_);
  }

 private:
  void head(const PageContext& context) {
    page_.name = study_.name;
    page_.question = study_.question;
    page_.plant = cat(study_.setup.plant.kind, study_.setup.preset.empty() ? "" : ", ", study_.setup.preset);
    page_.warnings = context.warnings;
    for (std::string& warning : study_warnings(study_)) page_.warnings.push_back(std::move(warning));
    std::ranges::copy(summary_.notes, std::back_inserter(page_.warnings));
    for (const std::string& missing : summary_.missing) page_.warnings.push_back(cat("Not measured: ", missing));
    std::size_t not_finite = 0;
    for (const Series& series : summary_.series) not_finite += series.not_finite;
    if (not_finite > 0)
      page_.warnings.push_back(cat(not_finite, " episodes gave NaN or infinite numbers; they count as failed."));
    page_.provenance = context.provenance;
    page_.study_text = study_.text;
    page_.run_command = context.run_command;
    page_.export_command = context.export_command;
    page_.interval =
        "95 % over training seeds; over episodes for a policy without seeds. Margins by Student’s t, the rest by a "
        "bootstrap";
  }

  void lists() {
    for (const StudyPolicy& policy : study_.policies)
      page_.policies.push_back({policy.name, kind_text(policy), policy.count()});
    metrics_ = summarised_metrics(study_);
    for (std::size_t i = 0; i < metrics_.size(); ++i) {
      const std::string& name = study_.metric_set.name(metrics_[i]);
      const MetricTraits& traits = study_.metric_set[metrics_[i]].traits();
      page_.metrics.push_back(page_metric(name, traits, study_.setup.plant->spec()));
      if (traits.role == MetricRole::survival) page_.survival_metric = i;
      if (traits.role == MetricRole::saturation) page_.saturation_metric = i;
      if (metrics_[i] == summary_.margin_metric) page_.margin_metric = i;
    }
    for (const StartProtocol& start : study_.starts) {
      page_.starts.push_back(
          {start.name, start.random ? cat(study_.episodes, " seeded starts") : cat(start.name, " start")});
    }
    for (std::size_t s = 0; s < study_.sweeps.size(); ++s) {
      if (study_.sweeps[s].axes.size() == 2 || study_.sweeps[s].axes.front().values.empty()) continue;
      sweep_at_[s] = page_.sweeps.size();
      page_.sweeps.push_back(page_sweep(study_, study_.sweeps[s]));
      page_.sweeps.back().command = cell_command(0, starts_to_tell(study_).front(), middle_of(study_.sweeps[s]));
    }
  }

  /// The command that measures a cell again.
  std::string cell_command(std::size_t policy, std::size_t start, const std::string& where) const {
    return cat("gust eval ", shell_word(study_.policies[policy].name), " --study ", shell_word(folder_), where,
               " --start ", shell_word(study_.starts[start].name));
  }

  void curves(const Series& series) {
    const std::size_t sweep = sweep_at_[series.sweep];
    for (std::size_t m = 0; m < metrics_.size(); ++m) {
      page_.curves.push_back(curve(series, sweep, m));
    }
    if (!series.has_margin) return;
    const Margin& margin = series.margin;
    page_.margins.push_back({sweep,
                             series.policy,
                             series.start,
                             {margin.level.estimate, margin.level.low, margin.level.high},
                             margin.censored,
                             summary_.undisturbed(series.policy, series.start),
                             margin_text(margin),
                             Page::kNone,
                             margin.reason});
  }

  /// One metric along a sweep: at its own levels and at those that the margin asked for.
  Page::Curve curve(const Series& series, std::size_t sweep, std::size_t m) const {
    Page::Curve curve{sweep, series.policy, series.start, m, {}};
    bool banded = false;
    const auto take = [&](const Estimate& estimate) {
      curve.band.value.push_back(estimate.value);
      curve.band.low.push_back(estimate.low);
      curve.band.high.push_back(estimate.high);
      banded = banded || std::isfinite(estimate.low);
    };
    const std::vector<double>& own = study_.sweeps[series.sweep].axes.front().values;
    std::size_t added = 0;
    for (std::size_t cell = 0; cell <= series.cells; ++cell) {
      const double before = cell < series.cells ? own[cell] : std::numeric_limits<double>::infinity();
      for (; added < series.added_levels.size() && series.added_levels[added] < before; ++added) {
        take(series.at_added(metrics_[m], added));
        curve.levels.push_back(series.added_levels[added]);
      }
      if (cell == series.cells) break;
      take(series.at(metrics_[m], cell));
      curve.levels.push_back(before);
    }
    if (added == 0) curve.levels.clear();
    if (!banded) curve.band.low = curve.band.high = {};
    return curve;
  }

  void compared(const SweepComparison& item) {
    const auto estimate = [](const Interval& from) { return Page::Estimate{from.estimate, from.low, from.high}; };
    const bool nominal = item.sweep == Trial::kNominal;
    const Comparison& found = item.found;
    Page::Comparison& to = page_.comparisons.emplace_back();
    to = {.a = item.pair.a, .b = item.pair.b, .start = item.pair.start};
    to.sweep = nominal ? Page::kNone : sweep_at_[item.sweep];
    to.name = nominal ? "undisturbed" : study_.sweeps[item.sweep].name;
    to.standing = item.standing_of(found.over.interval);
    to.difference = estimate(found.over.interval);
    to.ratio = estimate(found.ratio);
    to.ratio_most = found.ratio.most;
    to.improvement = estimate(found.improvement);
    for (const PairedDifference& at : found.scores) to.levels.push_back(item.standing_of(at.interval));
    to.needed = item.needed();
    to.few_seeds = item.seeds > 0 && item.seeds < kSeedsForVerdict;
  }

  void grid(const Series& series) {
    const Sweep& sweep = study_.sweeps[series.sweep];
    auto at = std::ranges::find(page_.grids, sweep.name, &Page::Grid::name);
    if (at == page_.grids.end()) {
      const auto axis = [&](std::size_t a) {
        return Page::Grid::Axis{sweep.axes[a].name(), sweep.unit(study_.setup.plant->spec(), a), sweep.axes[a].values};
      };
      page_.grids.push_back(
          {sweep.name, axis(1), axis(0), {}, cell_command(0, starts_to_tell(study_).front(), middle_of(sweep))});
      at = page_.grids.end() - 1;
    }
    for (std::size_t m = 0; m < metrics_.size(); ++m) {
      Page::Grid::Layer layer{series.policy, series.start, m, {}};
      layer.values.reserve(series.cells);
      for (std::size_t cell = 0; cell < series.cells; ++cell)
        layer.values.push_back(series.at(metrics_[m], cell).value);
      at->layers.push_back(std::move(layer));
    }
  }

  /// Each margin leads to a kept episode of its policy and sweep, from the same start if there is one: of each trial
  /// the worst comes first.
  void link_margins() {
    for (Page::Margin& margin : page_.margins) {
      for (const bool same_start : {true, false}) {
        const auto at = std::ranges::find_if(page_.episodes, [&](const Page::Episode& episode) {
          return episode.sweep == margin.sweep && episode.policy == margin.policy &&
                 (episode.start == margin.start) == same_start;
        });
        if (margin.episode == Page::kNone && at != page_.episodes.end())
          margin.episode = static_cast<std::size_t>(at - page_.episodes.begin());
      }
    }
  }

  /// Puts the page's starts into the order in which they are told.
  void order_starts(const std::string& first) {
    const std::vector<std::size_t> order = starts_to_tell(study_, first);
    std::vector<std::size_t> place(order.size());
    std::vector<Page::Start> starts;
    for (std::size_t i = 0; i < order.size(); ++i) {
      place[order[i]] = i;
      starts.push_back(std::move(page_.starts[order[i]]));
    }
    page_.starts = std::move(starts);
    for (Page::Curve& curve : page_.curves) curve.start = place[curve.start];
    for (Page::Margin& margin : page_.margins) margin.start = place[margin.start];
    for (Page::Comparison& comparison : page_.comparisons) comparison.start = place[comparison.start];
    for (Page::Episode& episode : page_.episodes) episode.start = place[episode.start];
    for (Page::Grid& grid : page_.grids) {
      for (Page::Grid::Layer& layer : grid.layers) layer.start = place[layer.start];
    }
  }

  void claims() {
    for (const ClaimVerdict& verdict : summary_.claims) {
      const Ruling ruling = verdict.finding.verdict.ruling;
      const Ruling shown = ruling == Ruling::not_testable ? Ruling::undecided : ruling;  // the number says "-"
      page_.claims.push_back({verdict.claim->id, verdict.claim->text, verdict.claim->holds,
                              measured_text(verdict.finding), shown, verdict.claim->required});
    }
  }

  void learning() {
    std::vector<LearningScore> scores = {{"return / horizon", &CurvePoint::anr_h},
                                         {"RMSE of safe-control-gym", &CurvePoint::rmse_scg}};
    if (!study_.metric_set[metrics_.front()].traits().higher_is_better)
      std::swap(scores[0], scores[1]);  // it asks for errors
    page_.learning_scores.clear();
    for (const LearningScore& score : scores) {
      for (std::size_t p = 0; p < study_.policies.size(); ++p) learning(p, score.column);
      page_.learning_scores.emplace_back(score.title);
    }
    const auto returns = std::ranges::find(scores, &CurvePoint::anr_h, &LearningScore::column);
    for (const ReferenceCurve& curve : study_.reference_curves) {
      const auto policy = std::ranges::find(study_.policies, curve.policy, &StudyPolicy::name);
      Page::Learning learning;
      learning.policy = static_cast<std::size_t>(policy - study_.policies.begin());
      learning.score = static_cast<std::size_t>(returns - scores.begin());
      learning.source = curve.source;
      learning.steps = curve.steps;
      learning.mean.value = curve.score;
      learning.runs.push_back({curve.source, curve.steps, curve.score});
      page_.learning.push_back(std::move(learning));
    }
  }

  /// The next score's curves of one policy.
  void learning(std::size_t policy, double CurvePoint::*column) {
    Page::Learning learning{.policy = policy, .score = page_.learning_scores.size(), .source = ""};
    std::vector<double> own_steps;
    for (const SeedCurve& curve : summary_.curves) {
      if (curve.policy != policy) continue;
      std::vector<double> own = add_run(curve, column, learning);
      if (own.size() > own_steps.size()) own_steps = std::move(own);
    }
    if (learning.runs.empty()) return;
    add_mean(learning);
    page_.learning.push_back(learning);
    if (own_steps == learning.steps || own_steps.size() != learning.mean.value.size()) return;
    Page::Learning own{
        .policy = policy, .score = learning.score, .source = "mean, by the steps that the policy learned from"};
    own.steps = std::move(own_steps);
    own.mean.value = learning.mean.value;
    page_.learning.push_back(std::move(own));
  }

  /// Returns the steps that the policy itself had learned from at each point.
  std::vector<double> add_run(const SeedCurve& curve, double CurvePoint::*column, Page::Learning& learning) {
    std::vector<double> own_steps;
    Page::Learning::Run run;
    run.seed = study_.policies[curve.policy].member(curve.member);
    for (const CurvePoint& point : curve.points) {
      run.steps.push_back(static_cast<double>(point.steps));
      run.score.push_back(point.*column);
      own_steps.push_back(static_cast<double>(point.protagonist_steps));
    }
    learning.runs.push_back(std::move(run));
    return own_steps;
  }

  /// The mean over seeds with its bootstrap interval, where all seeds were evaluated after the same steps. One that
  /// ended early, because it diverged, is no part of it.
  void add_mean(Page::Learning& learning) {
    std::vector<const Page::Learning::Run*> whole;
    for (const Page::Learning::Run& run : learning.runs) {
      if (!whole.empty() && run.steps.size() < whole.front()->steps.size()) continue;
      if (!whole.empty() && run.steps.size() > whole.front()->steps.size()) whole.clear();
      if (!whole.empty() && run.steps != whole.front()->steps) return;
      whole.push_back(&run);
    }
    Bootstrap bootstrap(Rng(static_cast<std::uint64_t>(study_.seed)).split("learning"), 2'000);
    learning.steps = whole.front()->steps;
    for (std::size_t i = 0; i < learning.steps.size(); ++i) {
      Matrix<double> scores(whole.size(), 1);
      for (std::size_t r = 0; r < whole.size(); ++r) scores.at(r, 0) = whole[r]->score[i];
      const Interval mean = interval(std::as_const(scores).view(), Statistic::mean, bootstrap);
      learning.mean.value.push_back(mean.estimate);
      learning.mean.low.push_back(mean.low);
      learning.mean.high.push_back(mean.high);
    }
  }

  const Study& study_;
  const Summary& summary_;
  std::vector<std::size_t> sweep_at_;
  std::vector<std::size_t> metrics_;
  std::string folder_;
  Page page_;
};

}  // namespace

Page study_page(const Study& study, const Summary& summary, const PageContext& context) {
  return PageWriter(study, summary).write(context);
}

}  // namespace gust
