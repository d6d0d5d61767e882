#include "gust/report/reproduction_results.h"

#include <algorithm>
#include <cmath>

#include "gust/core/text.h"
#include "gust/report/study_page.h"

namespace gust {
namespace {

Page::Estimate shown(const Estimate& estimate) { return {estimate.value, estimate.low, estimate.high}; }

std::size_t start_named(const Study& study, const std::string& name) {
  const auto at = std::ranges::find(study.starts, name, &StartProtocol::name);
  return at == study.starts.end() ? 0 : static_cast<std::size_t>(at - study.starts.begin());
}

/// Our value of a metric for a policy in a sweep of one cell, from random starts.
Page::Estimate measured(const Study& study, const Summary& summary, const std::string& policy, const std::string& sweep,
                        const std::string& metric) {
  const auto p = std::ranges::find(study.policies, policy, &StudyPolicy::name);
  const auto s = std::ranges::find(study.sweeps, sweep, &Sweep::name);
  if (p == study.policies.end() || s == study.sweeps.end()) return {};
  const Series* series = summary.find(static_cast<std::size_t>(p - study.policies.begin()),
                                      static_cast<std::size_t>(s - study.sweeps.begin()), start_named(study, "random"));
  return series == nullptr ? Page::Estimate{} : shown(series->at(study.metric_set.index(metric, {}), 0));
}

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
    cell.ours = measured(study, summary, value.column, value.row, figure.metric);
    cells.push_back(std::move(cell));
  }
  return cells;
}

/// A heat map of policies that differ in the level of their training: rows are their levels, columns those of the test.
std::optional<Page::Grid> map_of(const PaperMap& map, const Study& study, const Summary& summary, const Page& page) {
  const auto sweep = std::ranges::find(study.sweeps, map.sweep, &Sweep::name);
  if (sweep == study.sweeps.end()) return std::nullopt;
  const std::vector<double>& levels = sweep->axes.front().values;
  const std::string unit = sweep->unit(study.setup.plant->spec());
  Page::Grid grid{map.name, {"level in the test", unit, levels}, {"level in training", unit, levels}, {}, ""};
  const auto sweep_index = static_cast<std::size_t>(sweep - study.sweeps.begin());
  for (std::size_t start = 0; start < study.starts.size(); ++start) {
    for (std::size_t m = 0; m < page.metrics.size(); ++m) {
      Page::Grid::Layer layer{0, start, m, {}};
      for (const double level : levels) {
        std::string name = map.policies;
        name.replace(name.find("{level}"), 7, cat(level));
        const auto policy = std::ranges::find(study.policies, name, &StudyPolicy::name);
        if (policy == study.policies.end()) return std::nullopt;
        layer.policy = static_cast<std::size_t>(policy - study.policies.begin());
        const Series* series = summary.find(layer.policy, sweep_index, start);
        for (std::size_t cell = 0; cell < levels.size(); ++cell)
          layer.values.push_back(series ? series->at(summarised_metrics(study)[m], cell).value : Page::kUnknown);
      }
      grid.layers.push_back(std::move(layer));
    }
  }
  return grid;
}

ReproductionPage::Figure figure_of(const PaperResults& results, std::size_t index) {
  const Paper& paper = *results.reproduction.paper;
  const PaperFigure& figure = paper.figures[index];
  const std::size_t at = *results.reproduction.find(0, figure.study);
  const Study& study = results.reproduction.studies[at].study;
  const Summary& summary = results.summaries[at];
  ReproductionPage::Figure drawn;
  drawn.id = figure.study;
  drawn.place = figure.place;
  drawn.title = figure.title;
  drawn.says = figure.says;
  drawn.shows = figure.shows;
  drawn.table = table_of(paper, figure, study, summary);
  drawn.table_metric = figure.metric;
  drawn.page = study_page(
      study, summary, {cat("gust run studies/paper/", figure.study, ".toml"), cat(figure.study, ".gust"), "", {}, {}});
  drawn.page.study_text.clear();
  drawn.page.claims.clear();
  for (const PaperMap& map : figure.maps) {
    if (std::optional<Page::Grid> grid = map_of(map, study, summary, drawn.page)) drawn.page.grids.push_back(*grid);
  }
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    if (paper.claims[c].figure == figure.study && !results.on(c).empty()) drawn.claims.push_back(paper.claims[c].id);
  }
  return drawn;
}

}  // namespace

std::vector<std::size_t> verdict_counts(const PaperResults& results) {
  std::vector<std::size_t> counts(4);
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (!on.empty()) ++counts[static_cast<std::size_t>(on.front()->verdict.ruling)];
  }
  return counts;
}

ReproductionPage reproduction_page(const PaperResults& results, const std::string& command) {
  const Paper& paper = *results.reproduction.paper;
  ReproductionPage page;
  page.title = paper.title;
  page.source = paper.source;
  page.label = results.reproduction.profile->label;
  page.findings = findings(results);
  page.warnings = results.failures;
  page.run_command = command;
  page.provenance = results.provenance;
  for (const PaperReading& reading : paper.readings) page.readings.push_back({reading.name, reading.says});
  for (std::size_t f = 0; f < paper.figures.size(); ++f) {
    if (results.reproduction.find(0, paper.figures[f].study)) page.figures.push_back(figure_of(results, f));
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
                                paper.readings[verdict->reading].printed});
    }
    page.claims.push_back(std::move(shown));
  }
  return page;
}

}  // namespace gust
