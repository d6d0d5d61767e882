#include "gust/report/tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>

#include "gust/core/error.h"
#include "gust/report/answer.h"
#include "gust/report/html.h"

namespace gust {
namespace {

constexpr std::size_t kMostSmallest = 4;  // margins of one site
constexpr std::size_t kLongFact = 60;     // bytes; what is longer gets a row of its own

struct VerdictWords {
  std::string_view name;
  std::string_view sign;
};

VerdictWords words(Ruling verdict) {
  switch (verdict) {
    case Ruling::holds:
      return {"holds", "✓"};
    case Ruling::fails:
      return {"fails", "✗"};
    default:
      return {"undecided", "?"};
  }
}

std::string margin_row(const Page& page, const Page::Margin& margin) {
  const auto& sweep = page.sweeps[margin.sweep];
  const std::string watch = margin.episode == Page::kNone
                                ? ""
                                : cat("<button type=\"button\" data-watch=\"", margin.episode, "\">Watch</button>");
  return cat("<tr><th scope=\"row\" data-policy=\"", margin.policy, "\"><span class=\"key\" data-policy=\"",
             margin.policy, "\"></span>", escaped(page.policies[margin.policy].name), "</th><td>", escaped(sweep.name),
             "</td><td>", escaped(sweep.site), "</td><td>", margin_html(page, margin), "</td><td>", watch,
             "</td></tr>\n");
}

/// The smallest margins from a start, those of one site and unit together.
std::vector<const Page::Margin*> smallest(const Page& page, std::size_t start) {
  std::map<std::string, std::vector<const Page::Margin*>> groups;
  std::vector<std::string> order;
  for (const auto& margin : page.margins) {
    if (margin.start != start || margin.censored || std::isnan(margin.level.value)) continue;
    const std::string group = cat(page.sweeps[margin.sweep].site, " ", page.sweeps[margin.sweep].unit);
    if (!groups.contains(group)) order.push_back(group);
    groups[group].push_back(&margin);
  }
  std::vector<const Page::Margin*> all;
  for (const std::string& group : order) {
    std::vector<const Page::Margin*>& margins = groups[group];
    std::ranges::stable_sort(margins, {}, [](const Page::Margin* margin) { return margin->level.value; });
    if (margins.size() > kMostSmallest) margins.resize(kMostSmallest);
    std::ranges::copy(margins, std::back_inserter(all));
  }
  return all;
}

std::string code_line(std::string_view command) {
  return cat("<div class=\"command\"><code>", escaped(command),
             "</code><button type=\"button\" data-copy>Copy</button></div>");
}

}  // namespace

std::string smallest_margins(const Page& page) {
  std::string out;
  for (std::size_t start = 0; start < page.starts.size(); ++start) {
    const std::vector<const Page::Margin*> margins = smallest(page, start);
    if (margins.empty()) continue;
    out += cat("<div class=\"scroll by-start\" data-start=\"", start,
               "\" tabindex=\"0\" role=\"region\" aria-label=\"Smallest margins, ", escaped(page.starts[start].title),
               "\"><table class=\"smallest\">\n<thead><tr><th scope=\"col\">policy</th><th "
               "scope=\"col\">disturbance</th><th scope=\"col\">site</th><th scope=\"col\">margin</th><th "
               "scope=\"col\"><span class=\"hidden\">replay</span></th></tr></thead>\n<tbody>\n");
    for (const Page::Margin* margin : margins) out += margin_row(page, *margin);
    out += "</tbody></table></div>\n";
  }
  return out;
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
