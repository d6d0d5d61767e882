#include <algorithm>
#include <cmath>
#include <iterator>

#include "gust/core/text.h"
#include "gust/eval/aggregate.h"
#include "gust/report/html.h"
#include "gust/report/measured_findings.h"
#include "gust/report/printed_table.h"
#include "gust/report/reproduction_results.h"
#include "gust/report/verdicts.h"

namespace gust {
namespace {

/// The verdicts that decide.
std::vector<const PaperVerdict*> deciding(const PaperResults& results) {
  std::vector<const PaperVerdict*> all;
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (!on.empty()) all.push_back(on.front());
  }
  return all;
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
  return cat("Of ", counted(verdicts.size(), "claim", "claims"), " ", join(counts, ", "),
             ", under the reading that decides each; of their ", counted(parts, "part", "parts"), " ", true_parts,
             true_parts == 1 ? " is" : " are", " true at the estimate",
             left_out > 0 ? cat(", ", left_out, " more cannot be compared.") : ".");
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
                   : cat("Of the ", hard, " that the paper does not word softly, ", hold, hold == 1 ? " is" : " are",
                         " shown.");
}

/// What cannot be compared, and why.
std::string premises_sentence(const PaperResults& results) {
  std::vector<std::string> says;
  for (const PaperPremise& premise : results.reproduction.paper->premises) {
    std::vector<std::string> ids;
    for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
      const std::vector<const PaperVerdict*> on = results.on(c);
      const std::string& id = results.reproduction.paper->claims[c].id;
      const bool speaks = std::ranges::find(premise.claims, id) != premise.claims.end();
      if (speaks && !on.empty() && on.front()->left_out_parts > 0) ids.push_back(id);
    }
    if (!ids.empty())
      says.push_back(cat(premise.says, " Parts of claims that speak of it are not compared: ", join(ids, ", "), "."));
  }
  return join(says, " ");
}

/// What the paper leads with.
std::string leading_sentence(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  const auto leads = std::ranges::find(paper.claims, true, &PaperClaim::leads);
  const std::vector<const PaperVerdict*> on =
      leads == paper.claims.end() ? std::vector<const PaperVerdict*>() : results.on(leads - paper.claims.begin());
  if (on.empty()) return "";
  std::vector<std::string> otherwise;
  for (const PaperVerdict* verdict : on) {
    if (verdict->verdict.ruling == Ruling::holds && verdict != on.front())
      otherwise.push_back(paper.readings[verdict->reading].name);
  }
  const PaperVerdict& main = *on.front();
  const bool holds = main.verdict.ruling == Ruling::holds;
  return cat("What the paper leads with, ", leads->id, ", “", leads->text.substr(0, leads->text.find(" (")), "”, ",
             "is ", grade_name(main.grade()),
             holds ? "" : cat(", with ", main.true_parts, " of ", counted(main.parts, "part", "parts"), " true"),
             holds || otherwise.empty() ? "" : cat("; it is shown under ", join(otherwise, ", ")), ".");
}

/// Claims that are shown under one reading of the paper and refuted under another; the printed tables are no reading of
/// ours.
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
  if (changing.empty()) return "No claim is shown under one reading of the paper and refuted under another.";
  return cat(changing.size(), changing.size() == 1 ? " claim is" : " claims are",
             " shown under one reading of the paper and refuted under another: ", join(changing, ", "), ".");
}

/// Percentile intervals of few seeds cover less than they say: whose verdict that may have decided.
std::string narrow_intervals_sentence(const PaperResults& results) {
  std::size_t decided = 0;
  std::vector<std::string> falling;
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty() || !on.front()->decided() || results.reproduction.paper->claims[c].formula->calls("alike")) continue;
    ++decided;
    if (on.front()->widened != on.front()->verdict.ruling) falling.push_back(results.reproduction.paper->claims[c].id);
  }
  if (decided == 0) return "";
  return cat("Bootstrap intervals of few seeds are too narrow. Widened for that (decision 13), ",
             decided - falling.size(), " of the ", decided,
             " verdicts that show or refute stand, those of claims that compare intervals aside",
             falling.empty() ? "." : cat("; open become ", join(falling, ", "), "."));
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
  const std::string failed = cat(" The ", failing, " of the ", asked, " that are refuted would have come out true in ",
                                 percent(shares_of_failing / static_cast<double>(failing)), " of draws on average.");
  return cat(
      "With one training of each policy in place of all seeds, ", either_way, " of ", asked,
      " claims would hang on the draw (true in 10 to 90 % of draws); claims that compare intervals are left out.",
      failing == 0 ? "" : failed);
}

/// What the paper prints in its tables beside what we measured.
std::string tables_sentence(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  std::size_t printed = 0, measured = 0, within = 0, among = 0, strangers = 0, strange = 0;
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
      within += cell.ours.low <= cell.printed.value && cell.printed.value <= cell.ours.high ? 1 : 0;
      among += among_trainings(cell) ? 1 : 0;
      const Page::Estimate range = training_range(cell);
      if (among_trainings(cell)) ratios.push_back(range.high / range.low);
      for (const auto& other : cells) {  // what agreement is worth: another policy's number in the same range
        if (other.row != cell.row || other.column == cell.column) continue;
        ++strangers;
        strange += range.low <= other.printed.value && other.printed.value <= range.high ? 1 : 0;
      }
    }
    if (measured > measured_before)
      tables.push_back(cat(among - among_before, " of ", measured - measured_before, " in ", figure.place));
  }
  if (measured == 0) return "";
  return cat("Of the ", counted(measured, "number", "numbers"), " in the paper's tables",
             measured < printed ? " that were measured, " : ", ", counted(within, "lies", "lie"),
             " in the interval of our mean, and ", among,
             " between the least and the greatest of our single trainings: ", join(tables, ", "), ".",
             ratios.empty() ? ""
                            : fmt::format(" There these are a factor of {:.2g} apart (median); the number of another "
                                          "policy of the same row would lie between them in {}.",
                                          aggregate(Statistic::median, ratios),
                                          percent(static_cast<double>(strange) / static_cast<double>(strangers))));
}

}  // namespace

std::vector<std::string> findings(const PaperResults& results) {
  std::vector<std::string> sentences = {counts_sentence(results),       hardness_sentence(results),
                                        leading_sentence(results),      premises_sentence(results),
                                        tables_sentence(results),       reading_sentence(results),
                                        one_training_sentence(results), narrow_intervals_sentence(results)};
  std::ranges::move(measured_findings(results), std::back_inserter(sentences));
  std::erase(sentences, "");
  return sentences;
}

}  // namespace gust
