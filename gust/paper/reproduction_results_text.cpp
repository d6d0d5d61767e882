#include <algorithm>
#include <cmath>

#include "gust/core/text.h"
#include "gust/paper/printed_table.h"
#include "gust/paper/reproduction_results.h"
#include "gust/paper/verdicts.h"
#include "gust/report/html.h"

namespace gust {
namespace {

/// The text in a cell of a Markdown table.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.replace(at, 1, "\\|");
  std::ranges::replace(text, '\n', ' ');
  return text;
}

std::string number(const Page::Estimate& estimate) {
  const std::string value = short_number(estimate.value);
  if (std::isnan(estimate.low) || std::isnan(estimate.high)) return value;
  return cat(value, " [", short_number(estimate.low), ", ", short_number(estimate.high), "]");
}

std::string grade_text(Grade grade) {
  const std::string name(grade_name(grade));
  return grade == Grade::shown || grade == Grade::refuted ? cat("**", name, "**") : name;
}

/// The readings under which the verdict is another one: "refuted: saturate before; open: not terminated".
std::string other_verdicts(const ReproductionPage& page, const ReproductionPage::Claim& claim) {
  std::vector<std::string> parts;
  for (const Grade grade : {Grade::shown, Grade::open, Grade::refuted_in_part, Grade::refuted, Grade::not_comparable,
                            Grade::not_testable}) {
    std::vector<std::string> readings;
    for (const auto& verdict : claim.verdicts) {
      if (verdict.grade() == grade && grade != claim.verdicts.front().grade())
        readings.push_back(page.readings[verdict.reading].name);
    }
    if (!readings.empty()) parts.push_back(cat(grade_name(grade), ": ", join(readings, ", ")));
  }
  return parts.empty() ? (claim.verdicts.size() > 1 ? "none" : "–") : join(parts, "; ");
}

std::string claims_table(const ReproductionPage& page, const ReproductionPage::Figure& figure) {
  std::string text =
      "| claim | verdict | measured | parts true | true of one training each | another verdict under |\n"
      "| --- | --- | --- | --- | --- | --- |\n";
  for (const auto& claim : page.claims) {
    if (std::ranges::find(figure.claims, claim.id) == figure.claims.end()) continue;
    const auto& verdict = claim.verdicts.front();
    const std::string parts = parts_text(verdict);
    const std::string reading = verdict.reading == 0 ? "" : cat(" (", page.readings[verdict.reading].name, ")");
    text += cat("| ", claim.id, claim.hard ? "" : ", soft", ": ", cell(claim.text), " | ", grade_text(verdict.grade()),
                reading, " | ", std::isnan(verdict.measured.value) ? cell(verdict.reason) : number(verdict.measured),
                " | ", parts.empty() ? "–" : parts, " | ",
                std::isfinite(verdict.one_training) ? percent(verdict.one_training) : "–", " | ",
                cell(other_verdicts(page, claim)), " |\n");
  }
  return text + "\n";
}

/// "; 0.19, 0.17 to 11" of our single trainings.
std::string trainings_text(const ReproductionPage::TableCell& cell) {
  const Page::Estimate range = training_range(cell);
  if (!std::isfinite(range.value)) return "";
  return cat("; ", short_number(range.value), ", ", short_number(range.low), " to ", short_number(range.high));
}

/// "0.195 ± 0.087".
std::string printed_text(const Page::Estimate& printed) {
  const double deviation = (printed.high - printed.low) / 2;
  return cat(short_number(printed.value), std::isfinite(deviation) ? cat(" ± ", short_number(deviation)) : "");
}

/// " ± 0.087" of our episodes.
std::string deviation_text(const ReproductionPage::TableCell& cell) {
  return std::isfinite(cell.deviation) ? cat(" ± ", short_number(cell.deviation)) : "";
}

/// The paper's table beside ours: a line a row, a column a policy, the printed value first.
std::string table_text(const ReproductionPage::Figure& figure) {
  std::vector<std::string> rows, columns;
  for (const auto& value : figure.table) {
    if (std::ranges::find(rows, value.row) == rows.end()) rows.push_back(value.row);
    if (std::ranges::find(columns, value.column) == columns.end()) columns.push_back(value.column);
  }
  std::string text = cat("Printed → ours (", figure.table_metric, ", mean over seeds [interval]; ",
                         figure.over_episodes ? "± over episodes, as the paper's is; " : "",
                         "median of single trainings, least to greatest):\n\n|  |");
  for (const std::string& column : columns) text += cat(" ", cell(column), " |");
  text += "\n| --- |";
  for (std::size_t i = 0; i < columns.size(); ++i) text += " --- |";
  text += "\n";
  for (const std::string& row : rows) {
    text += cat("| ", cell(row), " |");
    for (const std::string& column : columns) {
      const auto at = std::ranges::find_if(
          figure.table, [&](const auto& value) { return value.row == row && value.column == column; });
      text += at == figure.table.end()
                  ? " |"
                  : cat(" ", printed_text(at->printed), " → ", number(at->ours),
                        figure.over_episodes ? deviation_text(*at) : "", trainings_text(*at), " |");
    }
    text += "\n";
  }
  return text + "\n";
}

}  // namespace

std::string reproduction_text(const PaperResults& results, const std::string& command) {
  const ReproductionPage page = reproduction_page(results, command);
  std::string text = cat("# ", page.title, "\n\n", page.source, ".\n\n");
  if (!page.label.empty()) text += cat("**", page.label, "**\n\n");
  for (const std::string& sentence : page.opening) text += cat("- ", sentence, "\n");
  text += cat(
      "\n## How to read the verdicts\n\nMade by `", command,
      "`; no number here was typed by hand. Verdicts are at 95 % over training seeds (percentile bootstrap), part by "
      "part: a claim is shown if all its parts are true throughout their intervals, refuted if one of them is true "
      "nowhere in its interval after Holm's correction for their number, else it is open, as it is from fewer than ",
      kSeedsForVerdict, " seeds. Seeds whose training diverged are left out, and named at the end. ", kMeasuredMeaning,
      "\n\n");
  if (!page.note.empty()) text += cat(page.note, "\n\n");
  if (!page.findings.empty()) text += "## What else the data show\n\n";
  for (const std::string& sentence : page.findings) text += cat("- ", sentence, "\n");
  const std::vector<ClaimsOfReason> reasons = claims_by_reason(page);
  if (!reasons.empty()) text += "\n## What is refuted or stays open, by the first reason that the data give\n\n";
  for (const auto& [why, claims] : reasons) {
    text += cat("- ", why, " ", counted(claims.size(), "claim", "claims"), ":\n");
    for (const auto* claim : claims)
      text += cat("  - ", claim->id, ": ", claim->text.substr(0, claim->text.find(" (")), ".\n");
  }
  text += "\n## How the paper can be read\n\n";
  const std::vector<Specification> specified = specifications(page);
  for (std::size_t r = 0; r < page.readings.size(); ++r) {
    const auto at = std::ranges::find(specified, r, &Specification::reading);
    text += cat("- **", page.readings[r].name, "**: ", page.readings[r].says,
                at == specified.end() ? ""
                                      : cat(" Of the parts of the ", counted(at->claims, "claim", "claims"),
                                            " that it bears on ", at->true_parts, " of ", at->parts, " are true."),
                "\n");
  }
  const std::string& checks = results.reproduction.paper->checks;
  if (!checks.empty()) text += cat("\n## Checks from outside\n\n", checks);
  for (const auto& figure : page.figures) {
    text += cat("\n## ", figure.place, ": ", figure.title, "\n\nThe paper: ", figure.says, "\n\n");
    if (!figure.trained.empty()) text += cat(figure.trained, "\n\n");
    if (!figure.table.empty()) text += table_text(figure);
    if (!figure.claims.empty()) text += claims_table(page, figure);
  }
  if (!page.warnings.empty()) text += "\n## What failed\n\n";
  for (const std::string& warning : page.warnings) text += cat("- ", warning, "\n");
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

}  // namespace gust
