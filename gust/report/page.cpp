#include "gust/report/page.h"

#include <algorithm>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/report/answer.h"
#include "gust/report/charts.h"
#include "gust/report/check_page.h"
#include "gust/report/document.h"
#include "gust/report/html.h"
#include "gust/report/page_data.h"
#include "gust/report/tables.h"

namespace gust {
namespace {

/// The study's own sentences, then what the margins say from each start; the page shows one start at a time.
std::string answers(const Page& page) {
  std::vector<std::string> own;
  for (const std::string& sentence : page.answer) own.push_back(escaped(sentence));
  std::string out = own.empty() ? "" : list_html(own, "says");
  const bool several = page.starts.size() > 1 && !page.margins.empty();
  if (several) out += "<div class=\"choices start-choices\"></div>\n";
  for (std::size_t start = 0; start < page.starts.size(); ++start) {
    const std::vector<std::string> sentences = answer_html(page, start);
    if (sentences.empty()) continue;
    const auto& [name, title] = page.starts[start];
    const std::string more = title == cat(name, " start") ? "" : cat(": ", title);
    out += cat("<div class=\"by-start\" data-start=\"", start, "\"><p class=\"from\">From the ", escaped(name),
               " start", escaped(more), "</p>\n", list_html(sentences, "says"), "</div>\n");
  }
  return out;
}

std::string answer_section(const Page& page, const std::vector<std::string>& left_out) {
  auto confidence = confidence_html(page);
  for (const auto& sentence : left_out) confidence.push_back(escaped(sentence));
  std::string out = cat("<div class=\"columns\"><div>", answers(page), "</div><aside><h3>How sure we are</h3>\n",
                        list_html(confidence, "notes"), "</aside></div>\n");
  if (const std::string table = margins_table(page); !table.empty()) {
    out += cat("<h3 id=\"margins\">Robustness margins</h3>\n<p class=\"lead\">The first level at which ",
               escaped(page.metrics[page.margin_metric].title), " falls below ",
               fmt::format("{:.0f} %", 100 * page.margin_share),
               " of its undisturbed value. Bar: interval, on the scale of its row. <b class=\"ahead\">Bold</b>: "
               "clearly ahead of all others; who undisturbed scores less than that share of the best is left "
               "out.</p>\n<div class=\"choices start-choices\" id=\"margin-choices\"></div>\n",
               table);
  }
  if (const std::string pairs = comparisons_html(page); !pairs.empty()) {
    out += cat("<h3 id=\"compared\">Which is better, and by how much</h3>\n<p class=\"lead\">",
               escaped(page.metrics[page.margin_metric].title), " of two policies on the same episodes, ",
               escaped(page.starts[page.comparisons.front().start].title),
               "; 95 % intervals. Difference: of the mean over the levels. Bar: who is ahead from the first level to "
               "the last; grey is undecided.</p>\n",
               pairs);
  }
  if (const std::string table = smallest_margins(page); !table.empty())
    out +=
        cat("<h3 id=\"smallest\">Smallest margins</h3>\n<p class=\"lead\">Of each site, from the start that is chosen "
            "above.</p>\n",
            table);
  return out;
}

std::string chart(const Page& page, std::string_view kind) {
  return has_chart(page, kind) ? chart_html(page, kind, cat("figure-", kind)) : "";
}

std::vector<Section> sections(const Page& page, const std::vector<std::string>& left_out) {
  std::vector<Section> all = {{"answer", "Answer", "The answer", answer_section(page, left_out)},
                              {"curves", "Curves", std::string(chart_title("curves")), chart(page, "curves")},
                              {"survival", "Survival", std::string(chart_title("survival")), chart(page, "survival")},
                              {"learning", "Learning", std::string(chart_title("learning")), chart(page, "learning")},
                              {"parameters", "Parameters", std::string(chart_title("parameters")),
                               chart(page, "parameters") + chart(page, "grids")},
                              {"replay", "Replay", std::string(chart_title("replay")), chart(page, "replay")},
                              {"claims", "Claims", "Claims", claims_list(page)},
                              {"provenance", "Provenance", "Where this comes from", provenance_html(page)}};
  std::erase_if(all, [](const Section& section) { return section.body.empty(); });
  return all;
}

std::string facts_line(const Page& page) {
  std::vector<std::string> parts = {counted(page.policies.size(), "policy", "policies"),
                                    counted(page.sweeps.size(), "sweep", "sweeps")};
  if (!page.episodes.empty()) parts.push_back(counted(page.episodes.size(), "kept episode", "kept episodes"));
  if (!page.claims.empty()) {
    const auto held = std::ranges::count(page.claims, Ruling::holds, &Page::Claim::verdict);
    parts.push_back(cat(held, " of ", counted(page.claims.size(), "claim holds", "claims hold")));
  }
  return join(parts, " · ");
}

std::string hero(const Page& page) {
  return cat("<header class=\"hero\">\n<p class=\"over\">Robustness study",
             page.plant.empty() ? "" : cat(" · ", escaped(page.plant)), "</p>\n<h1>", escaped(page.name),
             "</h1>\n<p class=\"question\">", escaped(page.question), "</p>\n<p class=\"facts-line\">",
             facts_line(page), "</p>\n</header>\n", warnings_html(page.warnings));
}

}  // namespace

std::string render_page(const Page& page) {
  check_page(page);
  const PageData data = page_data(page);
  Document document;
  document.name = page.name;
  document.places = page.policies.size();
  document.hero = hero(page);
  document.sections = sections(page, data.left_out);
  document.data = data_html(data.json, "gust-data");
  return document_html(document);
}

}  // namespace gust
