#include <algorithm>
#include <cmath>
#include <set>

#include "gust/core/text.h"
#include "gust/paper/measured_findings.h"
#include "gust/paper/printed_table.h"
#include "gust/paper/reproduction_results.h"
#include "gust/paper/verdicts.h"
#include "gust/report/html.h"
#include "gust/stats/aggregate.h"
#include "gust/study/plan/plan.h"

namespace gust {
namespace {

/// The verdict that decides a claim; null where it was not asked.
const PaperVerdict* deciding(const PaperResults& results, std::size_t claim) {
  const std::vector<const PaperVerdict*> on = results.on(claim);
  return on.empty() ? nullptr : on.front();
}

std::vector<const PaperVerdict*> deciding(const PaperResults& results) {
  std::vector<const PaperVerdict*> all;
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    if (const PaperVerdict* verdict = deciding(results, c)) all.push_back(verdict);
  }
  return all;
}

/// How much was trained, and under how many readings it was tested. Trainings that several readings share count once.
std::string run_sentence(const PaperResults& results) {
  std::set<std::string> trainings, agents;
  for (const ReproductionStudy& part : results.reproduction.studies) {
    for (const Trial& trial : expand(part.study, {}).trials) {
      if (trial.kind != Trial::Kind::kTrain) continue;
      trainings.insert(trial.id);
      agents.insert(part.study.policies[trial.policy].training()->agent.kind);
    }
  }
  std::set<std::size_t> readings;
  for (const PaperVerdict& verdict : results.verdicts) {
    if (!results.reproduction.paper->readings[verdict.reading].printed) readings.insert(verdict.reading);
  }
  if (trainings.empty()) return "";
  static const PaperFinding plain{.measure = "trainings",
                                  .says = "{trainings} of {agents} were tested under {readings} of the paper.",
                                  .pieces = {}};
  const PaperFinding* words = results.reproduction.paper->finding("trainings");
  return filled(words ? *words : plain, {.numbers = {{"trainings", counted(trainings.size(), "training", "trainings")},
                                                     {"agents", counted(agents.size(), "agent", "agents")},
                                                     {"readings", counted(readings.size(), "reading", "readings")}},
                                         .facts = {}});
}

/// "true in 90 % of resamples of the trainings".
std::string share_text(const PaperVerdict& verdict) {
  return std::isfinite(verdict.share) ? cat(", and true in ", percent(verdict.share), " of resamples of the trainings")
                                      : "";
}

std::string graded(const PaperVerdict& verdict) {
  return cat(grade_name(verdict.grade()), verdict.parts > 1 ? cat(", with ", verdict.true_parts, " of ",
                                                                  counted(verdict.parts, "part", "parts"), " true")
                                                            : "");
}

/// What became of a claim that the findings name, and of the same under the main reading.
std::string headline_sentence(const PaperResults& results, std::size_t claim) {
  const Paper& paper = *results.reproduction.paper;
  const std::vector<const PaperVerdict*> on = results.on(claim);
  if (on.empty()) return "";
  std::string text = cat("“", paper.claims[claim].headline, "” (", paper.claims[claim].id, ") is ", graded(*on.front()),
                         share_text(*on.front()));
  const auto main = std::ranges::find(on, std::size_t{0}, &PaperVerdict::reading);
  if (main != on.end() && *main != on.front())
    text += cat("; under ", paper.readings.front().name, " it is ", graded(**main));
  return text + ".";
}

/// What the paper prints in its tables beside what single trainings of ours give.
std::string tables_sentence(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  std::size_t printed = 0, measured = 0, among = 0, others = 0, others_between = 0;
  std::vector<double> ratios;
  std::vector<std::string> tables;
  for (const PaperFigure& figure : paper.figures) {
    const std::optional<std::size_t> at = results.reproduction.find(0, figure.study);
    if (!at || figure.table.empty()) continue;
    const std::size_t measured_before = measured, among_before = among;
    const auto cells = table_of(paper, figure, results.reproduction.studies[*at].study, results.summaries[*at]);
    for (const auto& cell : cells) {
      ++printed;
      if (cell.trainings.empty()) continue;
      ++measured;
      among += among_trainings(cell) ? 1 : 0;
      const Page::Estimate range = training_range(cell);
      if (among_trainings(cell)) ratios.push_back(range.high / range.low);
      for (const auto& other : cells) {  // what agreement is worth: another policy's number in the same range
        if (other.row != cell.row || other.column == cell.column) continue;
        ++others;
        others_between += range.low <= other.printed.value && other.printed.value <= range.high ? 1 : 0;
      }
    }
    if (measured > measured_before)
      tables.push_back(cat(among - among_before, " of ", measured - measured_before, " in ", figure.place));
  }
  if (measured == 0) return "";
  const std::string worth =
      ratios.empty() ? ""
                     : fmt::format(
                           ". There these are a factor of {:.2g} apart (median); the number of another policy of the "
                           "same row would lie between them in {}",
                           aggregate(Statistic::median, ratios),
                           percent(static_cast<double>(others_between) / static_cast<double>(others)));
  return cat("Of the ", counted(measured, "number", "numbers"), " in the paper's tables",
             measured < printed ? " that were measured" : "", ", ", counted(among, "lies", "lie"),
             " between the least and the greatest of our single trainings: ", join(tables, ", "), worth, ".");
}

/// What cannot be compared, and why.
std::string premises_sentence(const PaperResults& results) {
  std::vector<std::string> says;
  for (const PaperPremise& premise : results.reproduction.paper->premises) {
    std::size_t count = 0;
    for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
      const PaperVerdict* verdict = deciding(results, c);
      const bool speaks =
          std::ranges::find(premise.claims, results.reproduction.paper->claims[c].id) != premise.claims.end();
      count += speaks && verdict != nullptr && verdict->left_out_parts > 0 ? 1 : 0;
    }
    if (count > 0)
      says.push_back(
          cat(premise.says, " What ", counted(count, "claim says", "claims say"), " of it is not compared."));
  }
  return join(says, " ");
}

/// How many verdicts chance alone would give, claims aside that were named before the run: where the quantity that
/// decides is truly 0, one interval of twenty leaves it out.
std::string chance_text(const PaperResults& results) {
  constexpr double kChance = 0.05;
  std::size_t others = 0, decided = 0, all = 0, all_decided = 0;
  const Paper& paper = *results.reproduction.paper;
  for (const PaperVerdict& verdict : results.verdicts) {
    if (paper.claims[verdict.claim].primary || paper.readings[verdict.reading].printed || verdict.parts == 0) continue;
    const bool decides = &verdict == deciding(results, verdict.claim);
    others += decides ? 1 : 0;
    decided += decides && verdict.decided() ? 1 : 0;
    ++all;
    all_decided += verdict.decided() ? 1 : 0;
  }
  if (others == 0) return "";
  return fmt::format(
      " At the 5 % that intervals are made for, chance alone would show or refute about {:.0f} of the {} that were not "
      "named before the run ({}), and {:.0f} of their {} verdicts under all readings ({}); with few seeds it is more.",
      kChance * static_cast<double>(others), others, counted(decided, "is", "are"), kChance * static_cast<double>(all),
      all, counted(all_decided, "is", "are"));
}

std::string counts_sentence(const PaperResults& results) {
  const std::vector<const PaperVerdict*> verdicts = deciding(results);
  if (verdicts.empty()) return "";
  std::vector<std::string> counts;
  for (const Grade grade : {Grade::shown, Grade::open, Grade::refuted_in_part, Grade::refuted, Grade::not_comparable,
                            Grade::not_testable}) {
    const auto count =
        std::ranges::count_if(verdicts, [&](const PaperVerdict* verdict) { return verdict->grade() == grade; });
    if (count > 0)
      counts.push_back(cat(count, counts.empty() ? count == 1 ? " is " : " are " : " ", grade_name(grade)));
  }
  std::size_t parts = 0, true_parts = 0, left_out = 0;
  for (const PaperVerdict* verdict : verdicts) {
    parts += verdict->parts;
    true_parts += verdict->true_parts;
    left_out += verdict->left_out_parts;
  }
  return cat("Of ", counted(verdicts.size(), "claim", "claims"), " ", join(counts, ", "), "; of their ",
             counted(parts, "part", "parts"), " ", true_parts, true_parts == 1 ? " is" : " are",
             " true at the estimate", left_out > 0 ? cat(", ", left_out, " more cannot be compared.") : ".",
             chance_text(results));
}

/// How often one training of each policy, in place of all of them, would have shown what the paper says.
std::string one_training_sentence(const PaperResults& results) {
  std::size_t asked = 0, either_way = 0;
  for (const PaperVerdict* verdict : deciding(results)) {
    if (!std::isfinite(verdict->one_training)) continue;
    ++asked;
    either_way += hangs_on_draw(verdict->one_training) ? 1 : 0;
  }
  if (asked == 0) return "";
  return cat(
      "With one training of each policy, ", either_way, " of ", asked,
      " claims would hang on the draw: true in 10 to 90 % of draws. For a claim that puts one policy before another "
      "that share is the probability of improvement, ties apart.");
}

/// "C1 to C37 and C73", of claims in the paper's order.
std::string ids_text(const std::vector<PaperClaim>& claims, const std::vector<std::size_t>& which) {
  std::vector<std::string> runs;
  for (std::size_t i = 0; i < which.size();) {
    std::size_t end = i;
    while (end + 1 < which.size() && which[end + 1] == which[end] + 1) ++end;
    runs.push_back(end > i + 1 ? cat(claims[which[i]].id, " to ", claims[which[end]].id) : claims[which[i]].id);
    i = end > i + 1 ? end + 1 : i + 1;
  }
  const std::string last = runs.back();
  runs.pop_back();
  return runs.empty() ? last : cat(join(runs, ", "), " and ", last);
}

/// Which reading decides which claims.
std::string who_decides_sentence(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  std::vector<std::string> parts;
  for (std::size_t r = 1; r < paper.readings.size(); ++r) {
    std::vector<std::size_t> decided;
    for (std::size_t c = 0; c < paper.claims.size(); ++c) {
      const PaperVerdict* verdict = deciding(results, c);
      if (verdict != nullptr && verdict->reading == r) decided.push_back(c);
    }
    if (!decided.empty())
      parts.push_back(cat("‘", paper.readings[r].name, "’ decides ", ids_text(paper.claims, decided)));
  }
  if (parts.empty()) return "";
  return cat(join(parts, ", "), ", ‘", paper.readings.front().name,
             "’ the other claims; every other reading of the paper is told beside them.");
}

}  // namespace

std::vector<std::string> opening_findings(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  std::vector<std::string> sentences = {run_sentence(results)};
  for (const bool primary : {true, false}) {
    if (!primary) sentences.push_back(training_noise_sentence(results));
    for (std::size_t c = 0; c < paper.claims.size(); ++c) {
      if (!paper.claims[c].headline.empty() && paper.claims[c].primary == primary)
        sentences.push_back(headline_sentence(results, c));
    }
  }
  for (std::string sentence : {tables_sentence(results), premises_sentence(results), counts_sentence(results),
                               one_training_sentence(results), who_decides_sentence(results)})
    sentences.push_back(std::move(sentence));
  std::erase(sentences, "");
  return sentences;
}

}  // namespace gust
