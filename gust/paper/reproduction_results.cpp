#include "gust/paper/reproduction_results.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "gust/core/text.h"
#include "gust/report/html.h"
#include "gust/report/study_page.h"

namespace gust {
namespace {

Page::Estimate shown(const Estimate& estimate) { return {estimate.value, estimate.low, estimate.high}; }

std::size_t start_named(const Study& study, const std::string& name) {
  const auto at = std::ranges::find(study.starts, name, &StartProtocol::name);
  return at == study.starts.end() ? 0 : static_cast<std::size_t>(at - study.starts.begin());
}

/// Fills in our values of a metric, for the column's policy in the row's sweep of one cell, from random starts.
void fill_ours(const Study& study, const Summary& summary, const std::string& metric,
               ReproductionPage::TableCell& cell) {
  const auto p = std::ranges::find(study.policies, cell.column, &StudyPolicy::name);
  const auto s = std::ranges::find(study.sweeps, cell.row, &Sweep::name);
  if (p == study.policies.end() || s == study.sweeps.end()) return;
  const Series* series = summary.find(static_cast<std::size_t>(p - study.policies.begin()),
                                      static_cast<std::size_t>(s - study.sweeps.begin()), start_named(study, "random"));
  if (series == nullptr) return;
  const std::size_t index = study.metric_set.index(metric, {});
  cell.ours = shown(series->at(index, 0));
  if (index != study.metrics.front()) return;
  cell.trainings = series->trainings;
  cell.deviation = series->episode_deviation;
}

}  // namespace

std::vector<ReproductionPage::TableCell> table_of(const Paper& paper, const PaperFigure& figure, const Study& study,
                                                  const Summary& summary) {
  std::vector<ReproductionPage::TableCell> cells;
  for (const PrintedValue& value : paper.tables) {
    if (value.table != figure.table) continue;
    ReproductionPage::TableCell cell{value.row, value.column, {value.mean, Page::kUnknown, Page::kUnknown}, {}};
    if (std::isfinite(value.deviation)) {
      cell.printed.low = value.mean - value.deviation;
      cell.printed.high = value.mean + value.deviation;
    }
    fill_ours(study, summary, figure.metric, cell);
    cells.push_back(std::move(cell));
  }
  return cells;
}

namespace {

/// A page of maps in place of the policies that they are made of.
void draw_maps(const std::vector<PaperMap>& maps, const Study& study, const Summary& summary, const std::string& start,
               Page& page) {
  page.policies.clear();
  page.curves.clear();
  page.margins.clear();
  page.learning.clear();
  page.episodes.clear();
  for (const PaperMap& map : maps) {
    const auto sweep = std::ranges::find(study.sweeps, map.sweep, &Sweep::name);
    if (sweep == study.sweeps.end()) continue;
    auto grid = std::ranges::find(page.grids, map.sweep, &Page::Grid::name);
    if (grid == page.grids.end()) {
      const std::string unit = sweep->unit(study.setup.plant->spec());
      const std::vector<double>& levels = sweep->axes.front().values;
      page.grids.push_back(
          {map.sweep, {"level in the test", unit, levels}, {"level in training", unit, levels}, {}, ""});
      grid = page.grids.end() - 1;
    }
    const std::vector<std::size_t> starts = starts_to_tell(study, start);  // the page's are in this order
    for (std::size_t s = 0; s < starts.size(); ++s) {
      for (std::size_t metric = 0; metric < page.metrics.size(); ++metric) {
        std::vector<double> values;
        for (const Estimate& cell : map_cells(map, study, summary, summarised_metrics(study)[metric], starts[s]))
          values.push_back(cell.value);
        if (!values.empty()) grid->layers.push_back({page.policies.size(), s, metric, std::move(values)});
      }
    }
    page.policies.push_back({map.name, map.policies, 1});
  }
}

/// "200 000 steps".
std::string steps_text(std::int64_t steps) {
  std::string rest;
  for (; steps >= 1000; steps /= 1000) rest = cat(fmt::format(" {:03}", steps % 1000), rest);
  return cat(steps, rest, " steps");
}

/// "sac: 5 seeds of 200 000 steps; ppo, rarl, rap: 10 seeds of 1 000 000 steps", of what the study trains.
std::string trained_text(const Study& study) {
  constexpr std::size_t kMostNames = 7;
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;  // by seeds and steps
  for (const StudyPolicy& policy : study.policies) {
    if (!policy.training()) continue;
    std::string much =
        cat(counted(policy.count(), "seed", "seeds"), " of ", steps_text(policy.training()->agent->steps()));
    auto at = std::ranges::find(groups, much, &decltype(groups)::value_type::first);
    if (at == groups.end()) at = groups.insert(at, {std::move(much), {}});
    at->second.push_back(policy.name);
  }
  std::vector<std::string> parts;
  for (const auto& [much, names] : groups) {
    const std::string who = names.size() > kMostNames ? counted(names.size(), "policy", "policies") : join(names, ", ");
    parts.push_back(cat(who, ": ", much));
  }
  return parts.empty() ? "" : cat("Trained: ", join(parts, "; "), ".");
}

/// "+0.031 for raac", with a true minus sign.
std::string signed_text(double value, const std::string& name) {
  return cat(value < 0 ? "−" : "+", format("{:.3f}", std::abs(value)), " for ", name);
}

/// A policy's return over the horizon while it was trained.
struct LateCurve {
  double change = 0;  ///< of the last third of the training against the third before
  double peak = 0;    ///< of the mean over its trainings
  double end = 0;
};

LateCurve late_curve(const Summary& summary, std::size_t policy) {
  double sums[2] = {}, counts[2] = {};
  std::map<std::int64_t, std::pair<double, double>> at;  // sum and count
  for (const SeedCurve& curve : summary.curves) {
    if (curve.policy != policy || curve.points.empty()) continue;
    const std::int64_t whole = curve.points.back().steps;
    for (const CurvePoint& point : curve.points) {
      at[point.steps].first += point.anr_h;
      at[point.steps].second += 1;
      if (3 * point.steps <= whole) continue;
      const int third = 3 * point.steps > 2 * whole ? 1 : 0;
      sums[third] += point.anr_h;
      counts[third] += 1;
    }
  }
  LateCurve late{.change = sums[1] / counts[1] - sums[0] / counts[0]};
  for (const auto& [steps, sum] : at) {
    late.end = sum.first / sum.second;
    late.peak = std::max(late.peak, late.end);
  }
  return late;
}

/// Whether the curves are flat at their ends, and which were higher before; nothing where there are none.
std::string flatness_text(const Study& study, const Summary& summary) {
  if (summary.curves.empty()) return "";
  constexpr double kFlat = 0.02, kLost = 0.05;
  std::vector<std::string> changes, lost;
  for (std::size_t p = 0; p < study.policies.size(); ++p) {
    const LateCurve late = late_curve(summary, p);
    const std::string& name = study.policies[p].name;
    if (std::abs(late.change) > kFlat) changes.push_back(signed_text(late.change, name));
    if (late.peak - late.end > kLost) lost.push_back(format("{} {:.2f} after {:.2f}", name, late.end, late.peak));
  }
  const std::string others =
      fmt::format("by no more than {} for {}", kFlat, changes.empty() ? "any policy" : "the others");
  return cat(" In the last third of the training the return over the horizon changes ",
             changes.empty() ? "" : cat("by ", join(changes, ", "), ", and "), others, ", against the third before.",
             lost.empty() ? ""
                          : cat(" What is measured is the policy at the end of its training; the mean over trainings "
                                "was higher before: ",
                                join(lost, ", "), "."));
}

ReproductionPage::Figure figure_of(const PaperResults& results, std::size_t index, const std::string& command) {
  const Paper& paper = *results.reproduction.paper;
  const PaperFigure& figure = paper.figures[index];
  const std::size_t at = *results.reproduction.drawn(figure);
  const PaperReading& reading = paper.readings[results.reproduction.studies[at].reading];
  const Study& study = results.reproduction.studies[at].study;
  const Summary& summary = results.summaries[at];
  ReproductionPage::Figure drawn;
  drawn.id = figure.study;
  drawn.place = figure.place;
  drawn.title = figure.title;
  drawn.says = figure.says;
  drawn.trained = cat(trained_text(study), flatness_text(study, summary));
  if (&reading != &paper.readings.front()) drawn.trained = cat("Drawn under ‘", reading.name, "’. ", drawn.trained);
  if (!figure.note.empty()) drawn.trained += cat(drawn.trained.empty() ? "" : " ", figure.note);
  drawn.shows = figure.shows;
  drawn.table = table_of(paper, figure, study, summary);
  drawn.table_metric = figure.metric;
  drawn.over_episodes = figure.over_episodes;
  drawn.page = study_page(study, summary,
                          {.run_command = "",
                           .folder = cat(figure.study, ".gust"),
                           .export_command = "",
                           .provenance = {},
                           .warnings = {},
                           .start = reading.start});
  drawn.page.study_text.clear();
  drawn.page.claims.clear();
  drawn.page.run_command = cat(command, results.reproduction.choice.only.empty() ? cat(" --only ", figure.study) : "");
  for (Page::Sweep& sweep : drawn.page.sweeps) sweep.command.clear();  // they would ask a study's own folder
  for (Page::Grid& grid : drawn.page.grids) grid.command.clear();
  for (Page::Episode& episode : drawn.page.episodes) episode.command.clear();
  if (!figure.maps.empty()) draw_maps(figure.maps, study, summary, reading.start, drawn.page);
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    if (paper.claims[c].figure == figure.study && !results.on(c).empty()) drawn.claims.push_back(paper.claims[c].id);
  }
  return drawn;
}

}  // namespace

std::vector<Estimate> map_cells(const PaperMap& map, const Study& study, const Summary& summary, std::size_t metric,
                                std::size_t start) {
  const auto sweep = std::ranges::find(study.sweeps, map.sweep, &Sweep::name);
  if (sweep == study.sweeps.end()) return {};
  const std::vector<double>& levels = sweep->axes.front().values;
  std::vector<Estimate> cells;
  for (const double level : levels) {
    const auto policy = std::ranges::find(study.policies, map.policy(level), &StudyPolicy::name);
    if (policy == study.policies.end()) return {};
    const Series* series = summary.find(static_cast<std::size_t>(policy - study.policies.begin()),
                                        static_cast<std::size_t>(sweep - study.sweeps.begin()), start);
    for (std::size_t cell = 0; cell < levels.size(); ++cell)
      cells.push_back(series ? series->at(metric, cell) : Estimate{Page::kUnknown, Page::kUnknown, Page::kUnknown});
  }
  return cells;
}

ReproductionPage reproduction_page(const PaperResults& results, const std::string& command) {
  const Paper& paper = *results.reproduction.paper;
  ReproductionPage page;
  page.title = paper.title;
  page.source = paper.source;
  page.note = paper.note;
  page.label = results.label();
  Findings found = findings(results);
  page.opening = std::move(found.opening);
  page.findings = std::move(found.further);
  page.warnings = results.failures;
  page.run_command = command;
  page.provenance = results.provenance;
  for (const PaperReading& reading : paper.readings) page.readings.push_back({reading.name, reading.says});
  for (std::size_t f = 0; f < paper.figures.size(); ++f) {
    if (results.reproduction.drawn(paper.figures[f])) page.figures.push_back(figure_of(results, f, command));
  }
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    const PaperClaim& claim = paper.claims[c];
    if (results.on(c).empty()) continue;  // not all of its studies were to be run
    ReproductionPage::Claim shown{claim.id,    paper.figure(claim.figure)->place,
                                  claim.text,  claim.formula ? claim.formula->text() : "",
                                  !claim.soft, {}};
    for (const PaperVerdict* verdict : results.on(c)) {
      const Interval& measured = verdict->measured;
      shown.verdicts.push_back({verdict->reading,
                                verdict->verdict.ruling,
                                {measured.estimate, measured.low, measured.high},
                                verdict->seeds,
                                verdict->verdict.reason,
                                paper.readings[verdict->reading].printed,
                                verdict->one_training,
                                verdict->parts,
                                verdict->true_parts,
                                verdict->left_out_parts});
    }
    page.claims.push_back(std::move(shown));
  }
  return page;
}

}  // namespace gust
