#include "gust/study/trials/margin_trial.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "gust/core/text.h"
#include "gust/stats/quotient.h"
#include "gust/stats/statistics.h"
#include "gust/study/trials/cell_collector.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

constexpr std::string_view kLevelsFile = "levels.txt";  // a line a round: the levels looked at in it
constexpr std::size_t kMostRounds = 40;                 // more than any curve needs

/// What is measured of an episode for the score of the margins: the score, or the two metrics whose means it divides.
std::vector<std::size_t> measured_metrics(const Study& study) {
  const std::size_t score = margin_metric(study);
  const std::optional<Quotient> quotient = study.metric_set[score].quotient();
  if (!quotient) return {score};
  return {study.metric_set.index(quotient->numerator, {}), study.metric_set.index(quotient->denominator, {})};
}

/// The score of each episode of a cell, from what was measured of it.
Matrix<double> scores_of(const std::vector<Matrix<double>>& measured) {
  if (measured.size() == 1) return measured.front();
  return quotient_values(measured[0].view(), measured[1].view());
}

struct Stopped {};  // leaves an evaluation between two episodes

/// The evaluations that a margin's trial has among its inputs: undisturbed, or along the sweep.
TrialGroup inputs_of(const Plan& plan, const Trial& trial, bool nominal) {
  TrialGroup group{trial.policy, nominal ? Trial::kNominal : trial.sweep, {}};
  for (const std::size_t input : trial.inputs) {
    if (plan.trials[input].sweep == group.sweep) group.trials.push_back(input);
  }
  return group;
}

/// What is looked at in one trial.
class MarginSearch {
 public:
  MarginSearch(const Study& study, const Plan& plan, const Trial& trial, const Store& store)
      : study_(study), sweep_(trial.sweep), measured_(measured_metrics(study)), scores_(study, trial.sweep) {
    std::vector<std::string> missing;
    scores_.take_undisturbed(stored_rows(study, plan, inputs_of(plan, trial, true), store, missing));
    if (!missing.empty()) throw Error(cat("not in the store: ", missing.front()));
    const TrialGroup swept = inputs_of(plan, trial, false);
    if (scores_.hopeless()) return;
    MemberRows rows = stored_rows(study, plan, swept, store, missing);
    if (!missing.empty()) throw Error(cat("not in the store: ", missing.front()));
    const std::vector<double>& levels = study.sweeps[trial.sweep].axes.front().values;
    for (std::size_t cell = 0; rows.next(); ++cell) scores_.take(levels[cell], rows);
    for (const std::size_t input : swept.trials) {
      policies_.push_back(trial_policy(study, plan, plan.trials[input], store));
      tasks_.push_back(trial_evaluation(study, plan.trials[input]));
      tasks_.back()->evaluation.cells.resize(1);  // the others differ in the level alone
      tasks_.back()->evaluation.cells.shrink_to_fit();
    }
  }

  /// The levels that the curves from the starts ask for, ascending.
  std::vector<double> wanted() const {
    std::vector<double> levels;
    for (std::size_t start = 0; start < study_.starts.size(); ++start) {
      const MarginCurve& curve = scores_.curve(start);
      if (curve.levels.empty()) continue;
      if (curve.levels.front() > 0) levels.push_back(0.0);
      for (const double level : next_margin_levels(curve, {}, study_.margin_tolerance)) levels.push_back(level);
    }
    std::ranges::sort(levels);
    levels.erase(std::ranges::unique(levels).begin(), levels.end());
    return levels;
  }

  /// Evaluates every member at these levels; false if it was stopped.
  bool look(const std::vector<double>& levels, std::size_t round, TrialWriter& writer, const std::stop_token& stop) {
    const std::size_t starts = study_.starts.size();
    std::vector<std::vector<Matrix<double>>> found;  // [level][start][metric]: members x episodes
    for (std::size_t cell = 0; cell < levels.size() * starts; ++cell) {
      const bool same = episodes_repeat(study_, sweep_, cell % starts);
      const Matrix<double> empty(policies_.size(), same ? 1 : static_cast<std::size_t>(study_.episodes));
      found.emplace_back(measured_.size(), empty);
    }
    try {
      for (std::size_t member = 0; member < policies_.size(); ++member)
        evaluate_member(member, levels, writer.file(margin_rows_file(round, member)), found, stop);
    } catch (const Stopped&) {
      return false;
    }
    for (std::size_t cell = 0; cell < found.size(); ++cell) {
      const Matrix<double> scores = scores_of(found[cell]);
      scores_.take(levels[cell / starts], cell % starts, scores.view());
    }
    return true;
  }

 private:
  void evaluate_member(std::size_t member, const std::vector<double>& levels, OutputFile& file,
                       std::vector<std::vector<Matrix<double>>>& found, const std::stop_token& stop) {
    Evaluation evaluation = tasks_[member]->evaluation;
    const SweepCell plain = evaluation.cells.front();
    evaluation.cells.assign(levels.size(), plain);
    for (std::size_t i = 0; i < levels.size(); ++i) evaluation.cells[i].levels.back() = levels[i];
    RowsWriter rows(rows_header(study_, levels.size()), [&](std::string_view bytes) { file.append(bytes); });
    CellCollector collector(study_, evaluation, rows);
    evaluate(evaluation, *policies_[member], [&](const EpisodeIndex& index, const Episode& episode) {
      if (stop.stop_requested()) throw Stopped{};
      collector.take(index, episode);
      std::vector<Matrix<double>>& values = found[index.cell * study_.starts.size() + index.start];
      const auto place = static_cast<std::size_t>(index.episode);
      if (place >= values.front().lanes()) return;
      for (std::size_t m = 0; m < measured_.size(); ++m) values[m].at(member, place) = collector.last(measured_[m]);
    });
    rows.finish();
    file.close();
  }

  const Study& study_;
  std::size_t sweep_;
  std::vector<std::size_t> measured_;
  MarginScores scores_;
  std::vector<std::unique_ptr<Policy>> policies_;
  std::vector<std::unique_ptr<TrialEvaluation>> tasks_;
};

}  // namespace

void MarginScores::take_undisturbed(MemberRows rows) {
  if (!rows.next()) return;
  const std::string& score = study_.metric_set.name(margin_metric(study_));
  for (std::size_t start = 0; start < study_.starts.size(); ++start) {
    curves_.emplace_back();
    obstacles_.push_back(margin_obstacle(study_, sweep_, rows, start));
    if (obstacles_.back().empty()) curves_.back().undisturbed = margin_scores(rows.values(start, score).view());
  }
}

void MarginScores::take(double level, std::size_t start, Cell scores) {
  if (!obstacles_[start].empty()) return;  // nothing is kept of what has no margin
  MarginCurve& curve = curves_[start];
  curve.unit = unit_of(scores);
  std::vector<double> units = margin_scores(scores);
  const Sweep& sweep = study_.sweeps[sweep_];
  const bool alone = sweep.disturbed.empty() && sweep.parameters.empty();
  if (alone && curve.levels.empty() && curve.undisturbed.size() == units.size()) curve.add(0.0, curve.undisturbed);
  if (alone && curve.levels.empty() && curve.undisturbed.size() == 1)
    curve.add(0.0, std::vector(units.size(), curve.undisturbed.front()));
  curve.add(level, std::move(units));
}

void MarginScores::take(double level, const MemberRows& rows) {
  const std::string& score = study_.metric_set.name(margin_metric(study_));
  for (std::size_t start = 0; start < curves_.size() && rows.has(score); ++start)
    take(level, start, rows.values(start, score).view());
}

bool MarginScores::hopeless() const {
  return std::ranges::none_of(obstacles_, [](const std::string& obstacle) { return obstacle.empty(); });
}

Margin MarginScores::margin(std::size_t start) const {
  if (start >= curves_.size() || curve(start).levels.empty()) {
    const bool known = start < obstacles_.size() && !obstacles_[start].empty();
    return no_margin(known ? obstacles_[start] : "not measured");
  }
  Margin found = gust::margin(curve(start));
  if (found.level.estimate == 0) found.reason = "what stands beside the level costs more than a tenth by itself";
  return found;
}

std::string margin_obstacle(const Study& study, std::size_t sweep, const MemberRows& rows, std::size_t start) {
  if (const std::string reason = levels_obstacle(study.sweeps[sweep]); !reason.empty()) return reason;
  if (!rows.has(study.metric_set.name(margin_metric(study)))) return "not measured";
  const std::string survival = study.metric_set.name_of(MetricRole::survival);
  if (!rows.has(survival)) return "";
  const Matrix<double> survived = rows.values(start, survival);
  return survival_obstacle(mean(margin_scores(survived.view())));
}

std::string levels_obstacle(const Sweep& sweep) {
  const std::vector<double>& levels = sweep.axes.front().values;  // of "auto" none before they are found
  if (levels.size() == 1) return "it has one level; a margin needs two";
  if (levels.empty() || levels.front() >= 0) return "";
  return "its levels lie on both sides of 0 or below it; sweep each side from 0 (the factors of 'channels' turn the "
         "sign)";
}

std::string survival_obstacle(double share) {
  if (share >= 0.5) return "";
  return format("it fails undisturbed: {:.3g} % of the episodes last to the end", 100 * share);
}

Outcome run_margin(const Study& study, const Plan& plan, const Trial& trial, const Store& store, std::stop_token stop,
                   ProgressSink& progress) {
  MarginSearch search(study, plan, trial, store);
  TrialWriter writer = store.begin(kind_name(trial.kind), trial.id);
  std::string lines;
  for (std::size_t round = 0; round < kMostRounds; ++round) {
    const std::vector<double> levels = search.wanted();
    if (levels.empty()) break;
    if (!search.look(levels, round, writer, stop)) return {Outcome::State::stopped, ""};
    for (const double level : levels) lines += cat(level, level == levels.back() ? "\n" : " ");
    progress.set(1.0 - 1.0 / static_cast<double>(round + 2));
  }
  writer.write(kLevelsFile, lines);
  writer.commit(trial.canonical);
  return {};
}

std::string margin_rows_file(std::size_t round, std::size_t member) { return cat("rows-", round, "-", member, ".bin"); }

std::vector<std::vector<double>> margin_levels(const StoredTrial& stored) {
  std::vector<std::vector<double>> rounds;
  std::istringstream lines(stored.read(kLevelsFile));
  for (std::string line; std::getline(lines, line);) {
    std::vector<double>& levels = rounds.emplace_back();
    for (const std::string& word : split_text(line, ' ')) levels.push_back(number_from_text(word, kLevelsFile));
    if (levels.empty()) throw Error(cat(kLevelsFile, ":", rounds.size(), ": no levels"));
  }
  return rounds;
}

void for_each_margin_level(const Study& study, const Trial& trial, const StoredTrial& stored,
                           const std::function<void(double, const MemberRows&)>& take) {
  const std::vector<std::vector<double>> rounds = margin_levels(stored);
  for (std::size_t round = 0; round < rounds.size(); ++round) {
    std::vector<std::string> files;
    while (stored.contains(margin_rows_file(round, files.size())))
      files.push_back(margin_rows_file(round, files.size()));
    MemberRows rows = stored_rows(study, trial.sweep, stored, files);
    for (std::size_t i = 0; i < rounds[round].size() && rows.next(); ++i) take(rounds[round][i], rows);
  }
}

}  // namespace gust
