#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "gust/core/text.h"
#include "gust/eval/aggregate.h"
#include "gust/report/html.h"
#include "gust/report/printed_table.h"
#include "gust/report/reproduction_results.h"
#include "gust/report/verdicts.h"

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
  double value(const std::string& metric) const { return series->at(study->metric_set.index(metric, {}), cell).value; }
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

std::string counts_sentence(const PaperResults& results) {
  const std::vector<std::size_t> counts = verdict_counts(results);
  std::size_t asked = 0;
  for (const std::size_t count : counts) asked += count;
  if (asked == 0) return "";
  return cat("Of ", counted(asked, "claim", "claims"), " ", counted(counts[0], "holds", "hold"), ", ",
             counted(counts[1], "fails", "fail"), ", ", counted(counts[2], "is", "are"), " undecided and ", counts[3],
             " cannot be tested, under the reading that decides each.");
}

std::string hardness_sentence(const PaperResults& results) {
  std::size_t hard = 0, hold = 0;
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty() || results.reproduction.paper->claims[c].soft) continue;
    ++hard;
    hold += on.front()->verdict.ruling == Ruling::holds ? 1 : 0;
  }
  return hard == 0 ? ""
                   : cat("Of the ", hard, " that the paper states as facts, ", counted(hold, "holds", "hold"), ".");
}

/// Claims that hold under one reading of the paper and fail under another; the printed tables are no reading of ours.
std::string reading_sentence(const PaperResults& results) {
  std::vector<std::string> changing;
  const Paper& paper = *results.reproduction.paper;
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    bool holds = false, fails = false;
    for (const PaperVerdict* verdict : results.on(c)) {
      if (paper.readings[verdict->reading].printed) continue;
      holds = holds || verdict->verdict.ruling == Ruling::holds;
      fails = fails || verdict->verdict.ruling == Ruling::fails;
    }
    if (holds && fails) changing.push_back(paper.claims[c].id);
  }
  if (results.verdicts.empty()) return "";
  if (changing.empty()) return "No claim holds under one reading of the paper and fails under another.";
  return cat(changing.size(), changing.size() == 1 ? " claim holds" : " claims hold",
             " under one reading of the paper and ", changing.size() == 1 ? "fails" : "fail",
             " under another: ", join(changing, ", "), ".");
}

/// Percentile intervals of few seeds cover less than they say: whose verdict that may have decided.
std::string narrow_intervals_sentence(const PaperResults& results) {
  std::size_t decided = 0;
  std::vector<std::string> falling;
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty() || !on.front()->decided() || results.reproduction.paper->claims[c].formula->calls("alike")) continue;
    ++decided;
    if (!on.front()->stands_widened()) falling.push_back(results.reproduction.paper->claims[c].id);
  }
  if (decided == 0) return "";
  return cat("Bootstrap intervals of few seeds are too narrow. Widened for that (decision 13), ",
             decided - falling.size(), " of the ", decided,
             " verdicts that hold or fail stand, those of claims that compare intervals aside",
             falling.empty() ? "." : cat("; undecided become ", join(falling, ", "), "."));
}

/// How often one training of each policy, in place of all of them, would have shown what the paper says.
std::string one_training_sentence(const PaperResults& results) {
  std::size_t asked = 0, either_way = 0, failing = 0;
  double shares_of_failing = 0;
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty() || !std::isfinite(on.front()->one_training)) continue;
    ++asked;
    either_way += hangs_on_draw(on.front()->one_training) ? 1 : 0;
    if (on.front()->verdict.ruling != Ruling::fails) continue;
    ++failing;
    shares_of_failing += on.front()->one_training;
  }
  if (asked == 0) return "";
  const std::string failed = cat(" The ", failing, " of the ", asked, " that fail would have come out true in ",
                                 percent(shares_of_failing / static_cast<double>(failing)), " of draws on average.");
  return cat(
      "With one training of each policy in place of all seeds, ", either_way, " of ", asked,
      " claims would hang on the draw (true in 10 to 90 % of draws); claims that compare intervals are left out.",
      failing == 0 ? "" : failed);
}

/// What the paper's metric makes of episodes that fail early.
std::string early_failure_sentence(const PaperResults& results) {
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
  return fmt::format(
      "Where practically every episode fails ({} cells of policy, waveform, site and level) the paper's return over "
      "length "
      "still averages {:.2f}; over the whole horizon it is {:.2f}: the metric hides early failures.",
      cells, literal / count, honest / count);
}

/// How much of what is injected into actions the actuators cut off.
std::string saturation_sentence(const PaperResults& results) {
  double most = 0;
  std::string where;
  for_each_curve(results, [&](const Study& study, const Series& series) {
    const CurveCell cell{&study, &series, series.cells - 1};
    if (cell.sweep().injection->site != Site::kAction || cell.policy().kind != StudyPolicy::Kind::kTrain) return;
    const double share = cell.value("saturation");
    if (!(share > most)) return;
    most = share;
    const Series* undisturbed = results.summary(0, study.name)->find(series.policy, Trial::kNominal, series.start);
    where = cat(cell.policy().name, ", ", cell.sweep().name, " at ", cell.sweep().axes.front().values.back(), " ",
                cell.sweep().unit(study.setup.plant->spec()), "; undisturbed ",
                percent(undisturbed ? CurveCell{&study, undisturbed, 0}.value("saturation") : Page::kUnknown));
  });
  if (where.empty()) return "";
  return cat("Disturbed actions saturate: at the end of the grids up to ", percent(most), " of the control steps (",
             where, "), so that what is injected there reaches the plant only in part.");
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
      if (policy.kind != StudyPolicy::Kind::kTrain) continue;
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
    bool beyond_grid = true;  ///< of all of them
  };
  std::map<std::string, Best> disturbances;
  for_each_curve(results, [&](const Study& study, const Series& series) {
    const CurveCell cell{&study, &series, 0};
    if (!series.has_margin || !std::isfinite(series.margin.level.estimate) ||
        !stands_undisturbed(results, study, series))
      return;
    Best& best = disturbances[cat(study.setup.plant.kind, " ", cell.sweep().injection->canonical())];
    if (best.first == nullptr) best = {.first = &series, .study = &study, .site = cell.sweep().injection->site};
    if (best.study != &study || best.first->sweep != series.sweep) return;
    const double level = series.margin.level.estimate;
    best.beyond_grid = best.beyond_grid && series.margin.censored;
    if (cell.policy().kind == StudyPolicy::Kind::kLqr) best.regulator = level;
    if (cell.policy().kind == StudyPolicy::Kind::kTrain) best.agents = std::max(best.agents, level);
  });
  std::vector<std::string> parts;
  for (const auto& [site, what] : {std::pair{Site::kAction, "disturbed actions"},
                                   {Site::kDynamics, "dynamics"},
                                   {Site::kObservation, "observations"}}) {
    std::size_t compared = 0, ahead = 0;
    for (const auto& [name, best] : disturbances) {
      if (best.site != site || best.regulator == 0 || best.agents == 0 || best.beyond_grid) continue;
      ++compared;
      ahead += best.regulator >= best.agents ? 1 : 0;
    }
    if (compared > 0) parts.push_back(cat(ahead, " of ", compared, parts.empty() ? " sweeps of " : " of ", what));
  }
  if (parts.empty()) return "";
  return cat(
      "The linear regulator, which learned nothing, keeps 90 % of its score up to at least the level of the best "
      "agent in ",
      join(parts, ", "), ".");
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
        shares[capitals(study.policies[curve.policy].agent.kind)] =
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
  const StudyPolicy& policy = *std::ranges::find(study.policies, name, &StudyPolicy::name);
  std::string text = policy.agent.canonical;
  for (const Injection& injection : policy.disturbed) text += cat("; ", injection.canonical(), " ", injection.level);
  return text;
}

/// Whether it helps to train with the noise of the test: against a policy that was trained without any.
std::string training_noise_sentence(const PaperResults& results) {
  std::size_t better = 0, apart = 0;
  std::set<std::string> asked;
  for (const PaperFigure& figure : results.reproduction.paper->figures) {
    const Summary* summary = results.summary(0, figure.study);
    if (summary == nullptr) continue;
    const Study& study = results.reproduction.studies[*results.reproduction.find(0, figure.study)].study;
    const auto random = std::ranges::find(study.starts, true, &StartProtocol::random);
    for (const PaperMap& map : figure.maps) {
      const std::vector<Estimate> cells = map_cells(map, study, *summary, margin_metric(study),
                                                    static_cast<std::size_t>(random - study.starts.begin()));
      if (cells.empty()) continue;
      const Sweep& sweep = *std::ranges::find(study.sweeps, map.sweep, &Sweep::name);
      const std::vector<double>& levels = sweep.axes.front().values;
      for (std::size_t level = 1; level < levels.size(); ++level) {  // the first one is none
        const Estimate without = cells[level], with = cells[level * levels.size() + level];
        if (std::isnan(without.value) || std::isnan(with.value)) continue;
        if (!asked.insert(cat(training_of(study, map_policy(map, levels[level])), sweep.injection->canonical())).second)
          continue;
        better += with.value > without.value ? 1 : 0;
        apart += with.low > without.high ? 1 : 0;
      }
    }
  }
  if (asked.empty()) return "";
  return cat(
      "Where the heat maps test with noise, the policy that was trained with the same noise is better than the one "
      "that was trained without at ",
      better, " of ", asked.size(), " levels, beyond both intervals at ", apart, ".");
}

/// What the paper prints in its tables beside what we measured.
std::string tables_sentence(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  std::size_t printed = 0, measured = 0, within = 0, among = 0;
  std::vector<double> ratios;
  std::vector<std::string> tables;
  for (const PaperFigure& figure : paper.figures) {
    const std::optional<std::size_t> at = results.reproduction.find(0, figure.study);
    if (!at || figure.table.empty()) continue;
    const std::size_t measured_before = measured, among_before = among;
    for (const auto& cell : table_of(paper, figure, results.reproduction.studies[*at].study, results.summaries[*at])) {
      ++printed;
      if (cell.trainings.empty()) continue;
      ++measured;
      within += cell.ours.low <= cell.printed.value && cell.printed.value <= cell.ours.high ? 1 : 0;
      among += among_trainings(cell) ? 1 : 0;
      const Page::Estimate range = training_range(cell);
      ratios.push_back(range.high / range.low);
    }
    if (measured > measured_before)
      tables.push_back(cat(among - among_before, " of ", measured - measured_before, " in ", figure.place));
  }
  if (measured == 0) return "";
  return cat("Of the ", counted(measured, "number", "numbers"), " in the paper's tables",
             measured < printed ? " that were measured, " : ", ", counted(within, "lies", "lie"),
             " in the interval of our mean, and ", among,
             " between the least and the greatest of our single trainings, ",
             fmt::format("a factor of {:.2g} apart (median): ", aggregate(Statistic::median, ratios)),
             join(tables, ", "), ".");
}

}  // namespace

std::vector<std::string> findings(const PaperResults& results) {
  std::vector<std::string> sentences;
  for (std::string sentence :
       {counts_sentence(results), hardness_sentence(results), tables_sentence(results), reading_sentence(results),
        one_training_sentence(results), narrow_intervals_sentence(results), training_noise_sentence(results),
        undisturbed_sentence(results), early_failure_sentence(results), saturation_sentence(results),
        regulator_sentence(results), budget_sentence(results)}) {
    if (!sentence.empty()) sentences.push_back(std::move(sentence));
  }
  return sentences;
}

}  // namespace gust
