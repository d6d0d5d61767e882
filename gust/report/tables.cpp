#include "gust/report/tables.h"

#include <array>
#include <cmath>

#include "gust/core/error.h"
#include "gust/report/html.h"

namespace gust {
namespace {

constexpr std::size_t kMostWorst = 12;
constexpr std::size_t kLongFact = 60;  // bytes; what is longer gets a row of its own

struct VerdictWords {
  std::string_view name;
  std::string_view sign;
};

VerdictWords words(Page::Verdict verdict) {
  switch (verdict) {
    case Page::Verdict::kHolds:
      return {"holds", "✓"};
    case Page::Verdict::kFails:
      return {"fails", "✗"};
    case Page::Verdict::kUndecided:
      return {"undecided", "?"};
  }
  throw Bug("a verdict outside its enumeration");
}

std::string worst_row(const Page& page, const Page::WorstCell& cell) {
  const auto& sweep = page.sweeps[cell.sweep];
  const std::string where = sweep.site.empty() ? sweep.waveform : cat(sweep.site, " · ", sweep.waveform);
  const std::string watch = cell.episode == Page::kNone
                                ? ""
                                : cat("<button type=\"button\" data-watch=\"", cell.episode, "\">Watch</button>");
  return cat("<tr data-start=\"", cell.start, "\"><th scope=\"row\" data-policy=\"", cell.policy,
             "\"><span class=\"key\" data-policy=\"", cell.policy, "\"></span>",
             escaped(page.policies[cell.policy].name), "</th><td>", escaped(where), "</td><td class=\"number\">",
             short_number(cell.level), " ", escaped(sweep.unit), "</td><td class=\"number\"><span class=\"value\">",
             decimal(cell.score.value, 1), "</span> <span class=\"interval\">", interval_text(cell.score, 1),
             "</span></td><td class=\"number\">", decimal(cell.nominal, 1), "</td><td>",
             escaped(page.starts[cell.start].name), "</td><td>", watch, "</td></tr>\n");
}

std::string code_line(std::string_view command) {
  return cat("<div class=\"command\"><code>", escaped(command),
             "</code><button type=\"button\" data-copy>Copy</button></div>");
}

}  // namespace

std::string worst_table(const Page& page) {
  if (page.worst.empty()) return "";
  std::string out =
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Worst cells\"><table "
      "class=\"worst\">\n<thead><tr><th "
      "scope=\"col\">policy</th><th scope=\"col\">disturbance</th><th scope=\"col\" class=\"number\">level</th><th "
      "scope=\"col\" "
      "class=\"number\">score</th><th scope=\"col\" class=\"number\">undisturbed</th><th scope=\"col\">start</th><th "
      "scope=\"col\"><span class=\"hidden\">replay</span></th></tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < std::min(page.worst.size(), kMostWorst); ++i) out += worst_row(page, page.worst[i]);
  return out + "</tbody></table></div>\n";
}

std::string claims_list(const Page& page) {
  if (page.claims.empty()) return "";
  std::string out = "<ol class=\"claims\">\n";
  for (const auto& claim : page.claims) {
    const auto [name, sign] = words(claim.verdict);
    const std::string measured =
        claim.measured.empty() ? "" : cat(" <span class=\"measured\">measured ", escaped(claim.measured), "</span>");
    out += cat("<li class=\"", name, "\" id=\"claim-", escaped(claim.id),
               "\"><span class=\"verdict\"><span aria-hidden=\"true\">", sign, "</span> ", name, "</span><div><p>",
               escaped(claim.text), "</p><p class=\"detail\"><code>", escaped(claim.condition), "</code>", measured,
               claim.required ? " <span class=\"required\">required</span>" : "", " <span class=\"id\">",
               escaped(claim.id), "</span></p></div></li>\n");
  }
  return out + "</ol>\n";
}

std::string provenance_html(const Page& page) {
  std::string out = "<dl class=\"facts\">\n";
  for (const auto& [name, value] : page.provenance) {
    out += cat(value.size() > kLongFact ? "<div class=\"long\">" : "<div>", "<dt>", escaped(name), "</dt><dd>",
               escaped(value), "</dd></div>\n");
  }
  out += "</dl>\n";
  if (!page.run_command.empty()) out += cat("<h3>Make it again</h3>\n", code_line(page.run_command));
  if (!page.export_command.empty()) out += cat("<h3>All numbers, not rounded</h3>\n", code_line(page.export_command));
  if (!page.study_text.empty()) {
    out +=
        cat("<details class=\"study\"><summary>The study</summary><div class=\"command\"><pre tabindex=\"0\"><code>",
            escaped(page.study_text), "</code></pre><button type=\"button\" data-copy>Copy</button></div></details>\n");
  }
  return out;
}

}  // namespace gust
