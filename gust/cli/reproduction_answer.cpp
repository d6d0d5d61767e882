#include "gust/cli/reproduction_answer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gust/cli/command.h"
#include "gust/cli/progress_text.h"
#include "gust/core/text.h"
#include "gust/paper/reproduction_results.h"
#include "gust/report/html.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

/// "open (2)" where that few seeds cannot decide anything.
std::string grade_text(const PaperVerdict& verdict) {
  const std::string name(grade_name(verdict.grade()));
  return verdict.seeds > 0 && verdict.seeds < kSeedsForVerdict ? cat(name, " (", verdict.seeds, ")") : name;
}

/// Claims of the figures that were run which need another study as well.
std::string left_out_text(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    const PaperClaim& claim = paper.claims[c];
    std::vector<std::string> missing;
    for (const std::string& study : claim.from) {
      if (!results.reproduction.find(0, study)) missing.push_back(study);
    }
    if (!missing.empty() && missing.size() < claim.from.size())
      parts.push_back(cat(claim.id, " needs ", join(missing, " and ")));
  }
  return parts.empty() ? "" : cat("Not asked: ", join(parts, "; "), " (--only).");
}

/// A text that is wrapped in the columns beside the head of its line.
std::string beside(const std::string& head, const std::string& text, std::size_t columns) {
  const std::size_t indent = text_width(head);
  return cat(head, wrapped(text, columns - std::min(columns - 1, indent), indent));
}

/// A verdict with every part: what became of it, by how much it is true, and what its names stand for.
std::string parts_text(const Paper& paper, const PaperVerdict& verdict, std::size_t columns) {
  std::string text = cat(paper.readings[verdict.reading].name, ": ", grade_name(verdict.grade()), ", ",
                         verdict.true_parts, " of ", counted(verdict.parts, "part", "parts"), " true");
  if (verdict.left_out_parts > 0) text += cat(", ", verdict.left_out_parts, " not comparable");
  text = cat(wrapped(cat(text, "; ", verdict.verdict.reason), columns), "\n");
  std::string statement;
  for (const PartFinding& part : verdict.each_part) {
    if (part.statement != statement) {
      statement = part.statement;
      std::string line = statement;
      std::ranges::replace(line, '\n', ' ');
      text += cat("  ", wrapped(line, columns - 2, 2), "\n");
    }
    Interval margin = part.margin;
    margin.unit = Unit::none;
    const std::string_view ruling = part.ruling == Ruling::holds   ? "shown"
                                    : part.ruling == Ruling::fails ? "refuted"
                                    : part.is_true                 ? "open, true"
                                                                   : "open, false";
    const std::string head = fmt::format("    {:<12} {:<28} ", ruling, interval_text(margin));
    text += cat(beside(head, part.label, columns), "\n");
  }
  return text;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json parts_json(const PaperVerdict& verdict) {
  Json parts = Json::array();
  for (const PartFinding& part : verdict.each_part)
    parts.push_back({{"statement", part.statement},
                     {"names", part.label},
                     {"verdict", ruling_name(part.ruling)},
                     {"true", part.is_true},
                     {"estimate", number(part.margin.estimate)},
                     {"low", number(part.margin.low)},
                     {"high", number(part.margin.high)}});
  return parts;
}

Json all_findings(const PaperResults& results) {
  if (results.summaries.empty()) return Json::array();
  Findings found = findings(results);
  std::ranges::move(found.further, std::back_inserter(found.opening));
  return found.opening;
}

}  // namespace

std::string claims_text(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  const std::size_t columns = terminal_columns(STDOUT_FILENO, kUsualColumns);
  std::string text;
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty()) continue;
    text += cat(wrapped(cat(paper.claims[c].id, ": ", paper.claims[c].text), columns), "\n\n");
    for (const PaperVerdict* verdict : on) {
      if (verdict == on.front())
        text += cat(parts_text(paper, *verdict, columns), on.size() > 1 ? "\nOther readings\n" : "");
      else
        text += fmt::format("  {:<24} {:<16} {} of {} true\n", paper.readings[verdict->reading].name,
                            grade_name(verdict->grade()), verdict->true_parts, verdict->parts);
    }
    text += "\n";
  }
  return text;
}

std::string verdicts_text(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  const std::size_t columns = terminal_columns(STDOUT_FILENO, kUsualColumns);
  std::string text;
  if (const std::string label = results.label(); !label.empty()) text += cat(wrapped(label, columns), "\n\n");
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty()) continue;
    const auto same =
        std::ranges::count_if(on, [&](const PaperVerdict* verdict) { return verdict->grade() == on.front()->grade(); });
    const std::string head =
        fmt::format("{:<4} {:<15} {:>2}/{:<2}  ", paper.claims[c].id, grade_text(*on.front()), same, on.size());
    text += cat(beside(head, paper.claims[c].text, columns), "\n");
  }
  if (!results.verdicts.empty())
    text += cat(
        "\n",
        wrapped("The second column: under how many of the readings that bear on it the verdict is the same.", columns),
        "\n\n");
  if (const std::string left_out = left_out_text(results); !left_out.empty())
    text += cat(wrapped(left_out, columns), "\n\n");
  for (const std::string& sentence : opening_findings(results)) text += cat(wrapped(sentence, columns), "\n");
  return text;
}

std::string verdicts_json(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  Json claims = Json::array();
  for (const PaperVerdict& verdict : results.verdicts) {
    claims.push_back({{"id", paper.claims[verdict.claim].id},
                      {"reading", paper.readings[verdict.reading].name},
                      {"verdict", ruling_name(verdict.verdict.ruling)},
                      {"grade", grade_name(verdict.grade())},
                      {"parts", parts_json(verdict)},
                      {"left_out_parts", verdict.left_out_parts},
                      {"estimate", number(verdict.measured.estimate)},
                      {"low", number(verdict.measured.low)},
                      {"high", number(verdict.measured.high)},
                      {"seeds", verdict.seeds},
                      {"share", number(verdict.share)},
                      {"one_training", number(verdict.one_training)},
                      {"reason", verdict.verdict.reason}});
  }
  return Json{{"paper", paper.name},
              {"profile", results.reproduction.profile->name},
              {"label", results.label()},
              {"missing", results.missing},
              {"findings", all_findings(results)},
              {"claims", claims},
              {"failures", results.failures}}
      .dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace gust
