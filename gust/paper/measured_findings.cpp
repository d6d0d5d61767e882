#include "gust/paper/measured_findings.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "gust/core/text.h"
#include "gust/paper/reproduction_results.h"
#include "gust/report/html.h"
#include "gust/stats/aggregate.h"

namespace gust {
namespace {

/// The cells of the main reading's curves along levels, from random starts.
struct CurveCell {
  const Study* study = nullptr;
  const Series* series = nullptr;
  std::size_t cell = 0;

  const Sweep& sweep() const { return study->sweeps[series->sweep]; }
  const StudyPolicy& policy() const { return study->policies[series->policy]; }
  bool has(const std::string& metric) const {
    return std::ranges::find(series->metrics, study->metric_set.index(metric, {})) != series->metrics.end();
  }
  /// NaN where the study does not measure it.
  double value(const std::string& metric) const {
    return has(metric) ? series->at(study->metric_set.index(metric, {}), cell).value : Page::kUnknown;
  }
};

template <class Visit>
void for_each_curve(const PaperResults& results, Visit&& visit) {
  const Reproduction& reproduction = results.reproduction;
  for (std::size_t i = 0; i < reproduction.studies.size(); ++i) {
    const Study& study = reproduction.studies[i].study;
    if (reproduction.studies[i].reading != 0) continue;
    for (const Series& series : results.summaries[i].series) {
      if (series.sweep == Trial::kNominal || !study.starts[series.start].random) continue;
      if (study.sweeps[series.sweep].along_levels()) visit(study, series);
    }
  }
}

/// "RARL".
std::string capitals(std::string text) {
  for (char& letter : text) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  return text;
}

/// What return over length makes of episodes that fail early.
std::string early_failure_sentence(const PaperResults& results) {
  const PaperFinding* words = results.reproduction.paper->finding("early failure");
  if (words == nullptr) return "";
  std::size_t cells = 0;
  double literal = 0, honest = 0;
  for_each_curve(results, [&](const Study& study, const Series& series) {
    for (std::size_t c = 0; c < series.cells; ++c) {
      const CurveCell cell{&study, &series, c};
      if (!cell.has("anr") || !cell.has("anr_h") || !(cell.value("survival") < 0.05)) continue;
      ++cells;
      literal += cell.value("anr");
      honest += cell.value("anr_h");
    }
  });
  if (cells == 0) return "";
  const auto count = static_cast<double>(cells);
  if (literal < 1.5 * honest) return "";  // then it hides nothing
  return filled(*words, {.numbers = {{"cells", cat(cells)},
                                     {"return_over_length", fmt::format("{:.2f}", literal / count)},
                                     {"return_over_horizon", fmt::format("{:.2f}", honest / count)}},
                         .facts = {}});
}

/// How much of what is injected into actions the actuators cut off, and how much they do undisturbed.
std::string saturation_sentence(const PaperResults& results) {
  const Study* most_in = nullptr;
  const Summary* summary = nullptr;
  const Series* most = nullptr;
  double share = 0;
  for_each_curve(results, [&](const Study& study, const Series& series) {
    const CurveCell cell{&study, &series, series.cells - 1};
    if (cell.sweep().injection->site != Site::kAction || !cell.policy().training()) return;
    if (!(cell.value("saturation") > share)) return;
    share = cell.value("saturation");
    most_in = &study;
    most = &series;
    summary = results.summary(0, study.name);
  });
  if (most == nullptr) return "";
  std::vector<std::string> undisturbed;
  for (std::size_t p = 0; p < most_in->policies.size(); ++p) {
    const Series* series = summary->find(p, Trial::kNominal, most->start);
    if (series == nullptr || !most_in->policies[p].training()) continue;
    undisturbed.push_back(
        cat(percent(CurveCell{most_in, series, 0}.value("saturation")), " for ", most_in->policies[p].name));
  }
  const CurveCell cell{most_in, most, most->cells - 1};
  return cat("Disturbed actions saturate: at the end of the grids up to ", percent(share), " of the control steps (",
             cell.policy().name, ", ", cell.sweep().name, " at ", cell.sweep().axes.front().values.back(), " ",
             cell.sweep().unit(most_in->setup.plant->spec()),
             "), so that what is injected there reaches the plant only in part; undisturbed ", join(undisturbed, ", "),
             ".");
}

/// How often the policies of the first figure that shows learning hold out where nothing disturbs.
std::string undisturbed_sentence(const PaperResults& results) {
  std::vector<std::pair<double, std::string>> parts;
  for (std::size_t i = 0; i < results.summaries.size() && parts.empty(); ++i) {
    const Study& study = results.reproduction.studies[i].study;
    if (results.reproduction.studies[i].reading != 0 || results.summaries[i].curves.empty()) continue;
    for (const Series& series : results.summaries[i].series) {
      const StudyPolicy& policy = study.policies[series.policy];
      if (series.sweep != Trial::kNominal || !study.starts[series.start].random) continue;
      if (!policy.training()) continue;
      const double share = CurveCell{&study, &series, 0}.value("survival");
      if (std::isfinite(share)) parts.push_back({-share, cat(percent(share), " for ", policy.name)});
    }
  }
  if (parts.empty()) return "";
  std::ranges::sort(parts);
  std::vector<std::string> names;
  for (const auto& [share, text] : parts) names.push_back(text);
  return cat("Where nothing disturbs, the share of episodes that last to their end is ", join(names, ", "), ".");
}

/// Whether a policy's undisturbed score is one that margins are ranked from (decision 4).
bool stands_undisturbed(const PaperResults& results, const Study& study, const Series& series) {
  const Summary& summary = *results.summary(0, study.name);
  double best = 0;
  for (std::size_t policy = 0; policy < study.policies.size(); ++policy) {
    const double score = summary.undisturbed(policy, series.start);
    if (std::isfinite(score)) best = std::max(best, score);
  }
  return !falls_short(summary.undisturbed(series.policy, series.start), best);
}

/// Where a linear regulator stands more than every agent, each disturbance once: as the first figure has it.
std::string regulator_sentence(const PaperResults& results) {
  struct Best {
    const Series* first = nullptr;
    const Study* study = nullptr;
    Site site = Site::kAction;
    double regulator = 0;
    double agents = 0;
    bool regulator_beyond = false, agents_beyond = false;  ///< the level lies beyond the grid
  };
  std::map<std::string, Best> disturbances;
  for_each_curve(results, [&](const Study& study, const Series& series) {
    const CurveCell cell{&study, &series, 0};
    if (study.setup.plant.kind != results.reproduction.studies.front().study.setup.plant.kind) return;
    if (!series.has_margin || !std::isfinite(series.margin.level.estimate) ||
        !stands_undisturbed(results, study, series))
      return;
    Best& best = disturbances[cell.sweep().injection->canonical()];
    if (best.first == nullptr) best = {.first = &series, .study = &study, .site = cell.sweep().injection->site};
    if (best.study != &study || best.first->sweep != series.sweep) return;
    const double level = series.margin.level.estimate;
    if (cell.policy().kind == "lqr") {
      best.regulator = level;
      best.regulator_beyond = series.margin.censored;
    } else if (cell.policy().training()) {
      best.agents = std::max(best.agents, level);
      best.agents_beyond = best.agents_beyond || series.margin.censored;
    }
  });
  std::vector<std::string> parts;
  for (const auto& [site, what] : {std::pair{Site::kAction, "disturbed actions"},
                                   {Site::kDynamics, "dynamics"},
                                   {Site::kObservation, "observations"}}) {
    std::size_t compared = 0, ahead = 0;
    for (const auto& [name, best] : disturbances) {
      const bool both_beyond = best.regulator_beyond && best.agents_beyond;
      if (best.site != site || best.regulator == 0 || best.agents == 0 || both_beyond) continue;
      ++compared;
      ahead += best.regulator >= best.agents ? 1 : 0;
    }
    if (compared > 0) parts.push_back(cat(ahead, " of ", compared, parts.empty() ? " sweeps of " : " of ", what));
  }
  if (parts.empty()) return "";
  return cat(
      "The linear regulator, which learned nothing but is computed from the exact model, keeps 90 % of its score up to "
      "at least the level of the best agent in ",
      join(parts, ", "), ", by the estimates on the ", results.reproduction.studies.front().study.setup.plant.kind,
      "; disturbances that both stand to the end of the grid are left out.");
}

/// Agents whose own policy learned from a part of the steps only.
std::string budget_sentence(const PaperResults& results) {
  std::map<std::string, double> shares;
  for (std::size_t i = 0; i < results.summaries.size(); ++i) {
    const Study& study = results.reproduction.studies[i].study;
    if (results.reproduction.studies[i].reading != 0) continue;
    for (const SeedCurve& curve : results.summaries[i].curves) {
      const CurvePoint& last = curve.points.back();
      if (last.steps > 0 && last.protagonist_steps < last.steps)
        shares[capitals(study.policies[curve.policy].training()->agent.kind)] =
            static_cast<double>(last.protagonist_steps) / static_cast<double>(last.steps);
    }
  }
  std::vector<std::string> parts;
  for (const auto& [agent, share] : shares) parts.push_back(cat(agent, "'s policy learns from ", percent(share)));
  if (parts.empty()) return "";
  return cat("At equal numbers of steps ", join(parts, ", "), " of them; the rest trains its adversary.");
}

/// All that makes the policy of a map, but the number of its seeds: maps of several figures may share it.
std::string training_of(const Study& study, const std::string& name) {
  const PolicyTraining* training = std::ranges::find(study.policies, name, &StudyPolicy::name)->training();
  if (training == nullptr) return name;
  std::string text = training->agent.canonical();
  for (const Injection& injection : training->disturbed) text += cat("; ", injection.canonical(), " ", injection.level);
  return text;
}

/// Policies that were trained with the noise of the test beside those that were trained without, level by level.
struct NoiseCount {
  std::size_t levels = 0;
  std::size_t better = 0;
  std::size_t apart = 0;        ///< better, beyond both intervals
  std::size_t worse_apart = 0;  ///< worse, beyond both intervals
  std::vector<double> noisy;    ///< undisturbed scores of policies that were trained with noise
  std::vector<double> clean;    ///< of those that were trained without
};

/// Adds the levels of one map from one start. `asked` are those that an earlier map had.
void count_noise(const PaperMap& map, const Study& study, const std::vector<Estimate>& cells,
                 std::set<std::string>& asked, NoiseCount& count) {
  const Sweep& sweep = *std::ranges::find(study.sweeps, map.sweep, &Sweep::name);
  const std::vector<double>& levels = sweep.axes.front().values;
  for (std::size_t level = 0; level < levels.size(); ++level) {  // the first one is none
    const Estimate undisturbed = cells[level * levels.size()], without = cells[level],
                   with = cells[level * levels.size() + level];
    if (std::isnan(without.value) || std::isnan(with.value)) continue;
    if (!asked.insert(cat(training_of(study, map.policy(levels[level])), sweep.injection->canonical())).second)
      continue;
    (level == 0 ? count.clean : count.noisy).push_back(undisturbed.value);
    if (level == 0) continue;
    ++count.levels;
    count.better += with.value > without.value ? 1 : 0;
    count.apart += with.low > without.high ? 1 : 0;
    count.worse_apart += with.high < without.low ? 1 : 0;
  }
}

/// Over the maps of a figure's study, from random starts or from the one that is none.
NoiseCount training_noise(const PaperResults& results, const PaperFigure& figure, std::size_t at, bool random) {
  NoiseCount count;
  std::set<std::string> asked;
  const Study& study = results.reproduction.studies[at].study;
  const auto start = std::ranges::find(study.starts, random, &StartProtocol::random);
  if (start == study.starts.end()) return count;
  for (const PaperMap& map : figure.maps) {
    const std::vector<Estimate> cells =
        map_cells(map, study, results.summaries[at], study.metric_set.index("anr_h", {}),
                  static_cast<std::size_t>(start - study.starts.begin()));
    if (!cells.empty()) count_noise(map, study, cells, asked, count);
  }
  return count;
}

std::string counts_text(const NoiseCount& count) {
  return cat(count.better, " of ", count.levels, " levels (clearly at ", count.apart, ", clearly worse at ",
             count.worse_apart, ")");
}

std::string mean_text(const std::vector<double>& values) {
  return fmt::format("{:.2f}", aggregate(Statistic::mean, values));
}

}  // namespace

std::string training_noise_sentence(const PaperResults& results) {
  const Reproduction& reproduction = results.reproduction;
  const PaperFinding* words = reproduction.paper->finding("training noise");
  const auto figure = std::ranges::find_if(reproduction.paper->figures, [&](const PaperFigure& each) {
    return !each.maps.empty() && reproduction.drawn(each);
  });
  if (words == nullptr || figure == reproduction.paper->figures.end()) return "";
  const std::size_t drawn = *reproduction.drawn(*figure), main = *reproduction.find(0, figure->study);
  const NoiseCount tested = training_noise(results, *figure, drawn, false),
                   near = training_noise(results, *figure, drawn, true),
                   other = training_noise(results, *figure, main, true);
  if (tested.levels == 0 || near.levels == 0) return "";
  Measured measured{.numbers = {{"tested", counts_text(tested)},
                                {"near", counts_text(near)},
                                {"other", counts_text(other)},
                                {"reading", reproduction.paper->readings.front().name},
                                {"noisy_tested", mean_text(tested.noisy)},
                                {"noisy_near", mean_text(near.noisy)},
                                {"clean_tested", mean_text(tested.clean)},
                                {"clean_near", mean_text(near.clean)}},
                    .facts = {}};
  if (drawn != main) measured.facts.insert("elsewhere");
  if (2 * tested.better < tested.levels && 2 * other.better > other.levels) measured.facts.insert("reversed");
  return filled(*words, measured);
}

std::vector<std::string> measured_findings(const PaperResults& results) {
  return {undisturbed_sentence(results), early_failure_sentence(results), saturation_sentence(results),
          regulator_sentence(results), budget_sentence(results)};
}

}  // namespace gust
