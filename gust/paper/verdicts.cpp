#include "gust/paper/verdicts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/report/html.h"

namespace gust {
namespace {

constexpr std::array kGrades = {Grade::shown,   Grade::open,           Grade::refuted_in_part,
                                Grade::refuted, Grade::not_comparable, Grade::not_testable};

/// The class of a grade in the style sheet, and the end of its mark's name.
std::string_view style_of(Grade grade) {
  switch (grade) {
    case Grade::shown:
      return "holds";
    case Grade::open:
      return "undecided";
    case Grade::refuted_in_part:
      return "partly";
    case Grade::refuted:
      return "fails";
    case Grade::not_comparable:
    case Grade::not_testable:
      break;
  }
  return "untested";
}

std::string mark(Grade grade) {
  return cat("<svg class=\"mark\" aria-hidden=\"true\"><use href=\"#mark-", style_of(grade), "\"/></svg>");
}

/// The mark on its colour; decided ones are solid.
std::string stamp(Grade grade, std::string_view title = "") {
  return cat("<span class=\"stamp ", style_of(grade), "\"", title.empty() ? "" : cat(" title=\"", title, "\""), ">",
             mark(grade), "</span>");
}

std::string_view meaning(Grade grade) {
  switch (grade) {
    case Grade::shown:
      return "all its parts are true throughout their intervals";
    case Grade::open:
      return "intervals leave a part open, or too few seeds";
    case Grade::refuted_in_part:
      return "a part is false throughout its interval, others are true";
    case Grade::refuted:
      return "false throughout, and no part is true";
    case Grade::not_comparable:
      return "what it takes for granted did not happen here";
    case Grade::not_testable:
      return "a datum is missing";
  }
  throw Bug("a grade outside its enumeration");
}

/// The verdict of the reading that decides.
Ruling main_ruling(const ReproductionPage::Claim& claim) {
  return claim.verdicts.empty() ? Ruling::not_testable : claim.verdicts.front().ruling;
}
Grade main_grade(const ReproductionPage::Claim& claim) {
  return claim.verdicts.empty() ? Grade::not_testable : claim.verdicts.front().grade();
}

/// Whether a claim has this verdict under a reading of ours, or of the paper's printed numbers.
bool ruled(const ReproductionPage::Claim& claim, Ruling ruling, bool printed) {
  return std::ranges::any_of(
      claim.verdicts, [&](const auto& verdict) { return verdict.ruling == ruling && verdict.printed == printed; });
}

std::string link_to(const ReproductionPage::Claim& claim) {
  return cat("<a href=\"#claim-", escaped(claim.id), "\">", escaped(claim.id), "</a>");
}

std::string cell(const ReproductionPage::Claim& claim) {
  const Grade grade = main_grade(claim);
  const bool hangs = hangs_on_reading(claim);
  return cat("<li><a class=\"cell ", style_of(grade), hangs ? " hangs" : "", "\" href=\"#claim-", escaped(claim.id),
             "\" title=\"", escaped(claim.text), "\">", mark(grade), escaped(claim.id), "<span class=\"hidden\"> ",
             grade_name(grade), hangs ? ", hangs on the reading" : "", "</span></a></li>\n");
}

std::string count_html(const ReproductionPage& page, Grade grade) {
  const auto count = std::ranges::count(page.claims, grade, main_grade);
  return cat("<div><dt>", stamp(grade), grade_name(grade), "<small>", meaning(grade), "</small></dt><dd>", count,
             "</dd></div>\n");
}

const ReproductionPage::Verdict* verdict_under(const ReproductionPage::Claim& claim, std::size_t reading) {
  const auto at = std::ranges::find(claim.verdicts, reading, &ReproductionPage::Verdict::reading);
  return at == claim.verdicts.end() ? nullptr : &*at;
}

std::string reading_row(const ReproductionPage& page, std::size_t reading) {
  const std::string name = escaped(page.readings[reading].name);
  std::string out = cat("<tr><th scope=\"row\">", name, "</th>");
  for (const auto& claim : page.claims) {
    const ReproductionPage::Verdict* verdict = verdict_under(claim, reading);
    if (!verdict) {
      out += "<td></td>";
      continue;
    }
    const std::string_view grade = grade_name(verdict->grade());
    out += cat("<td>", stamp(verdict->grade(), cat(escaped(claim.id), ", ", name, ": ", grade)),
               "<span class=\"hidden\">", grade, "</span></td>");
  }
  return out + "</tr>\n";
}

std::string reading_matrix(const ReproductionPage& page) {
  std::string out =
      cat("<div class=\"scroll readings\" tabindex=\"0\" role=\"region\" aria-label=\"Verdicts by reading\"><table "
          "style=\"--claims:",
          page.claims.size(), "\">\n<thead><tr><th scope=\"col\">reading</th>");
  for (const auto& claim : page.claims) {
    out += cat("<th scope=\"col\"", hangs_on_reading(claim) ? " class=\"hangs\"" : "", " title=\"", escaped(claim.text),
               "\">", link_to(claim), "</th>");
  }
  out += "</tr></thead>\n<tbody>\n";
  for (std::size_t reading = 0; reading < page.readings.size(); ++reading) out += reading_row(page, reading);
  return out + "</tbody></table></div>\n";
}

std::string readings_list(const ReproductionPage& page) {
  std::string out = "<h3>The readings</h3>\n<dl class=\"facts\">\n";
  for (const auto& [name, says] : page.readings) {
    const bool is_main = &name == &page.readings.front().name;
    out += cat("<div><dt>", escaped(name), is_main ? " <b>main</b>" : "", "</dt><dd>", escaped(says), "</dd></div>\n");
  }
  return out + "</dl>\n";
}

/// "✓ shown: scg-2022, saturate before" for each grade that a claim gets.
std::string by_grade(const ReproductionPage& page, const ReproductionPage::Claim& claim) {
  std::string out;
  for (const Grade grade : kGrades) {
    std::vector<std::string> names;
    for (const auto& verdict : claim.verdicts) {
      if (verdict.grade() == grade) names.push_back(escaped(page.readings[verdict.reading].name));
    }
    if (names.empty()) continue;
    out += cat("<span class=\"under\">", stamp(grade), " ", grade_name(grade), ": ", join(names, ", "), "</span>");
  }
  return out;
}

std::string changing_list(const ReproductionPage& page) {
  std::string items;
  for (const auto& claim : page.claims) {
    if (!hangs_on_reading(claim)) continue;
    items += cat("<li><span class=\"id\">", link_to(claim), "</span><div><p>", escaped(claim.text),
                 "</p><p class=\"detail\">", by_grade(page, claim), "</p></div></li>\n");
  }
  if (items.empty()) return "";
  return cat("<h3>Claims that hang on a reading</h3>\n<ul class=\"changing\">\n", items, "</ul>\n");
}

double largest(const Page::Estimate& estimate) {
  double size = 0;
  for (const double value : {estimate.value, estimate.low, estimate.high}) {
    if (std::isfinite(value)) size = std::max(size, std::abs(value));
  }
  return size;
}

std::string measured_html(const ReproductionPage::Verdict& verdict) {
  if (std::isnan(verdict.measured.value)) return "";
  const double scale = largest(verdict.measured);
  return cat("<b class=\"value\">", decimal(verdict.measured.value, scale), "</b> <span class=\"interval\">",
             interval_text(verdict.measured, scale), "</span>");
}

std::string seeds_text(const ReproductionPage::Verdict& verdict) {
  return verdict.seeds == 0 ? "" : counted(verdict.seeds, "seed", "seeds");
}

/// The reason without the number and the seeds that stand beside it already.
std::string reason_beyond_number(const ReproductionPage::Verdict& verdict) {
  const std::string number =
      interval_text(Interval{verdict.measured.value, verdict.measured.low, verdict.measured.high});
  std::vector<std::string> parts = split_text(verdict.reason, ';');
  for (std::string& part : parts) part.erase(0, std::min(part.find_first_not_of(' '), part.size()));
  std::erase(parts, number);
  std::erase(parts, cat(number, " (", seeds_text(verdict), ")"));
  return join(parts, "; ");
}

bool has_parts(const ReproductionPage::Verdict& verdict) { return verdict.parts + verdict.left_out_parts > 1; }

std::string pill(Grade grade) {
  return cat("<span class=\"verdict ", style_of(grade), "\">", mark(grade), " ", grade_name(grade), "</span>");
}

std::string other_readings(const ReproductionPage& page, const ReproductionPage::Claim& claim) {
  std::string rows;
  for (std::size_t i = 1; i < claim.verdicts.size(); ++i) {
    const ReproductionPage::Verdict& verdict = claim.verdicts[i];
    rows += cat("<tr><th scope=\"row\">", escaped(page.readings[verdict.reading].name), "</th><td>",
                pill(verdict.grade()), "</td><td>", measured_html(verdict), "</td><td>",
                has_parts(verdict) ? cat("parts true: ", parts_text(verdict)) : "", "</td><td>", seeds_text(verdict),
                "</td><td class=\"reason\">", escaped(reason_beyond_number(verdict)), "</td></tr>\n");
  }
  if (rows.empty()) return "";
  return cat(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Other readings\"><table "
      "class=\"other\"><tbody>\n",
      rows, "</tbody></table></div>\n");
}

/// The formula and the other readings, folded; the summary shows what the other readings say.
std::string folded(const ReproductionPage& page, const ReproductionPage::Claim& claim) {
  const std::string others = other_readings(page, claim);
  if (others.empty() && claim.formula.empty()) return "";
  std::string stamps;
  for (std::size_t i = 1; i < claim.verdicts.size(); ++i) {
    const ReproductionPage::Verdict& verdict = claim.verdicts[i];
    stamps +=
        stamp(verdict.grade(), cat(escaped(page.readings[verdict.reading].name), ": ", grade_name(verdict.grade())));
  }
  const bool asked = !claim.formula.empty();
  std::string summary = asked ? "Formula" : "";
  if (!stamps.empty())
    summary += cat(asked ? ", other readings" : "Other readings", " <span class=\"stamps\">", stamps, "</span>");
  return cat("<details class=\"judged\"><summary>", summary, "</summary>",
             !asked ? "" : cat("<pre tabindex=\"0\"><code>", escaped(claim.formula), "</code></pre>"), others,
             "</details>");
}

}  // namespace

std::string mark_shapes() {
  return "<svg class=\"hidden\" aria-hidden=\"true\">"
         "<symbol id=\"mark-holds\" viewBox=\"0 0 16 16\"><path d=\"M3 8.6L6.6 12.2L13 4.4\"/></symbol>"
         "<symbol id=\"mark-fails\" viewBox=\"0 0 16 16\"><path d=\"M4 4L12 12M12 4L4 12\"/></symbol>"
         "<symbol id=\"mark-partly\" viewBox=\"0 0 16 16\"><path d=\"M4 12L12 4\"/></symbol>"
         "<symbol id=\"mark-undecided\" viewBox=\"0 0 16 16\"><circle cx=\"8\" cy=\"8\" r=\"4.8\"/><path "
         "class=\"half\" "
         "d=\"M8 3.2A4.8 4.8 0 0 0 8 12.8Z\"/></symbol>"
         "<symbol id=\"mark-untested\" viewBox=\"0 0 16 16\"><path d=\"M4 8H12\"/></symbol></svg>\n";
}

bool hangs_on_reading(const ReproductionPage::Claim& claim) {
  return ruled(claim, Ruling::holds, false) && ruled(claim, Ruling::fails, false);
}

std::string parts_text(const ReproductionPage::Verdict& verdict) {
  std::string text = verdict.parts == 0 ? "" : cat(verdict.true_parts, " of ", verdict.parts);
  if (verdict.left_out_parts > 0) text += cat(text.empty() ? "" : ", ", verdict.left_out_parts, " not comparable");
  return text;
}

bool hangs_on_draw(double one_training) { return one_training >= 0.1 && one_training <= 0.9; }

std::vector<ClaimsOfReason> claims_by_reason(const ReproductionPage& page) {
  using Claim = ReproductionPage::Claim;
  const auto share = [](const Claim& claim) { return claim.verdicts.front().one_training; };
  const std::pair<const char*, std::function<bool(const Claim&)>> reasons[] = {
      {"Too few seeds to decide.",
       [](const Claim& claim) {
         const std::size_t seeds = claim.verdicts.front().seeds;
         return seeds > 0 && seeds < kSeedsForVerdict;
       }},
      {"It is shown under another reading, or in other words, than what decides.",
       [](const Claim& claim) { return ruled(claim, Ruling::holds, false); }},
      {"It is open, and one training of each policy would show it in 10 to 90 % of draws.",
       [&](const Claim& claim) { return main_ruling(claim) == Ruling::undecided && hangs_on_draw(share(claim)); }},
      {"The paper's own printed numbers do not show it either.",
       [](const Claim& claim) { return ruled(claim, Ruling::fails, true); }},
      {"Most single trainings show it, but their mean leaves it open.",
       [&](const Claim& claim) { return share(claim) > 0.9; }},
      {"It is refuted over all seeds, though single trainings of ours show it in 10 to 90 % of draws.",
       [&](const Claim& claim) { return hangs_on_draw(share(claim)); }},
      {"Hardly a single training of ours shows it, and it is shown under no reading of ours.",
       [&](const Claim& claim) { return share(claim) < 0.1; }},
      {"One training alone cannot show it, and it is shown under no reading of ours.",
       [&](const Claim& claim) {
         return !std::isfinite(share(claim)) && claim.verdicts.front().seeds >= kSeedsForVerdict;
       }},
      {"None that these data know.", [](const Claim&) { return true; }},
  };
  std::vector<ClaimsOfReason> found;
  for (const auto& [why, applies] : reasons) found.push_back({why, {}});
  for (const Claim& claim : page.claims) {
    if (main_ruling(claim) != Ruling::fails && main_ruling(claim) != Ruling::undecided) continue;
    std::size_t reason = 0;
    while (!reasons[reason].second(claim)) ++reason;
    found[reason].claims.push_back(&claim);
  }
  std::erase_if(found, [](const ClaimsOfReason& one) { return one.claims.empty(); });
  return found;
}

std::string claims_by_reason_html(const ReproductionPage& page) {
  std::string items;
  for (const ClaimsOfReason& one : claims_by_reason(page)) {
    std::vector<std::string> links;
    for (const auto* claim : one.claims) links.push_back(link_to(*claim));
    items += cat("<div><dt>", escaped(one.why), "</dt><dd>", counted(links.size(), "claim", "claims"), ": ",
                 join(links, ", "), "</dd></div>\n");
  }
  if (items.empty()) return "";
  return cat("<h3>What is refuted or stays open, by the first reason that the data give</h3>\n<dl class=\"facts\">\n",
             items, "</dl>\n");
}

std::string verdict_picture(const ReproductionPage& page) {
  std::string cells;
  for (const auto& claim : page.claims) cells += cell(claim);
  std::string counts;
  for (const Grade grade : kGrades) counts += count_html(page, grade);
  const bool hang = std::ranges::any_of(page.claims, hangs_on_reading);
  const std::string reading = "Each under the reading that decides it: the first, unless the claim says another.";
  return cat("<div class=\"picture\"><ol class=\"cells\">\n", cells, "</ol>\n<div><dl class=\"counts\">\n", counts,
             "</dl>\n<p class=\"note\">", reading, " ", kMeasuredMeaning, "</p>",
             hang ? "<p class=\"note\"><span class=\"fold\"></span> It is shown under one reading and refuted under "
                    "another.</p>"
                  : "",
             "</div></div>\n");
}

std::string reading_table(const ReproductionPage& page) {
  if (page.readings.size() < 2) return "";
  const auto hang = std::ranges::count_if(page.claims, hangs_on_reading);
  return cat("<p class=\"lead\">The paper leaves open what some of its words mean. ", hang, " of ",
             counted(page.claims.size(), "claim", "claims"), hang == 1 ? " is" : " are",
             " shown under one reading and refuted under another. An empty place: the reading does not bear on the "
             "claim.</p>\n",
             specification_curve(page), "<h3>Claim by claim</h3>\n", reading_matrix(page), readings_list(page),
             changing_list(page));
}

std::string claim_html(const ReproductionPage& page, const ReproductionPage::Claim& claim) {
  const ReproductionPage::Verdict none;
  const ReproductionPage::Verdict& verdict = claim.verdicts.empty() ? none : claim.verdicts.front();
  std::vector<std::string> details;
  if (const std::string measured = measured_html(verdict); !measured.empty())
    details.push_back(cat("measured ", measured));
  if (verdict.seeds > 0) details.push_back(seeds_text(verdict));
  if (std::isfinite(verdict.one_training))
    details.push_back(cat("true of one training each in ", percent(verdict.one_training)));
  if (has_parts(verdict)) details.push_back(cat("parts true: ", parts_text(verdict)));
  if (!claim.hard) details.push_back("worded softly");
  if (!claim.place.empty()) details.push_back(escaped(claim.place));
  if (verdict.reading > 0) details.push_back(cat("under ", escaped(page.readings[verdict.reading].name)));
  if (hangs_on_reading(claim)) details.push_back("<b>hangs on the reading</b>");
  const std::string reason = reason_beyond_number(verdict);
  std::string line;
  for (const auto& detail : details) line += cat("<span>", detail, "</span>");
  return cat("<li id=\"claim-", escaped(claim.id), "\">", pill(verdict.grade()), "<div><p><span class=\"id\">",
             escaped(claim.id), "</span> ", escaped(claim.text), "</p><p class=\"detail\">", line, "</p>",
             reason.empty() ? "" : cat("<p class=\"reason\">", escaped(reason), "</p>"), folded(page, claim),
             "</div></li>\n");
}

}  // namespace gust
