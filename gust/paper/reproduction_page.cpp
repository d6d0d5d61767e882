#include "gust/paper/reproduction_page.h"

#include <algorithm>
#include <map>
#include <set>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/paper/printed_table.h"
#include "gust/paper/verdicts.h"
#include "gust/report/assets.h"
#include "gust/report/charts.h"
#include "gust/report/check_page.h"
#include "gust/report/document.h"
#include "gust/report/html.h"
#include "gust/report/page_data.h"
#include "gust/report/tables.h"

namespace gust {
namespace {

using Figure = ReproductionPage::Figure;

constexpr std::size_t kDataLimit = 16'000'000;  // bytes of all figures; the page must stay under 20 MB

void check_claims(const ReproductionPage& page) {
  std::set<std::string_view> ids;
  for (const auto& claim : page.claims) {
    GUST_CHECK(ids.insert(claim.id).second);
    for (const auto& verdict : claim.verdicts) GUST_CHECK(verdict.reading < page.readings.size());
  }
  for (const auto& figure : page.figures) {
    for (const auto& id : figure.claims) GUST_CHECK(ids.erase(id) == 1);  // each belongs to one figure
  }
}

void check_reproduction(const ReproductionPage& page) {
  check_claims(page);
  std::set<std::string_view> ids;
  for (const auto& figure : page.figures) {
    GUST_CHECK(ids.insert(figure.id).second);
    check_page(figure.page);
    for (const auto& kind : figure.shows) {
      GUST_CHECK(std::ranges::count(figure.shows, kind) == 1);
      GUST_CHECK(std::ranges::count(chart_kinds(), kind) == 1);
    }
  }
}

/// Where each policy stands in the order of colours: one that several figures show looks the same in all of them.
class Places {
 public:
  explicit Places(const ReproductionPage& page) {
    std::map<std::string_view, std::size_t> figures;
    for (const auto& figure : page.figures) {
      for (const auto& policy : figure.page.policies) {
        if (++figures[policy.name] == 2) common_.emplace(policy.name, common_.size());
      }
    }
  }

  /// Policies of this figure alone take what is free.
  std::vector<std::size_t> of(const Page& page) const {
    std::set<std::size_t> taken;
    for (const auto& policy : page.policies) {
      if (const auto at = common_.find(policy.name); at != common_.end()) taken.insert(at->second);
    }
    std::vector<std::size_t> places;
    std::size_t next = 0;
    for (const auto& policy : page.policies) {
      const auto at = common_.find(policy.name);
      while (at == common_.end() && taken.contains(next)) ++next;
      places.push_back(at != common_.end() ? at->second : next++);
    }
    return places;
  }

  /// One more than the last place that any figure uses.
  std::size_t count(const ReproductionPage& page) const {
    std::size_t count = 0;
    for (const auto& figure : page.figures) {
      for (const std::size_t place : of(figure.page)) count = std::max(count, place + 1);
    }
    return count;
  }

 private:
  std::map<std::string_view, std::size_t> common_;
};

std::vector<std::string> shown_charts(const Figure& figure) {
  std::vector<std::string> out;
  std::ranges::copy_if(figure.shows, std::back_inserter(out),
                       [&](const std::string& kind) { return has_chart(figure.page, kind); });
  return out;
}

/// The data of each figure that has charts, all of them within the limit: the largest give way first.
std::vector<PageData> figure_data(const ReproductionPage& page) {
  const Places places(page);
  std::vector<PageData> out;
  std::vector<std::size_t> sizes;
  for (const auto& figure : page.figures) {
    const bool drawn = !shown_charts(figure).empty();
    out.push_back(drawn ? page_data(figure.page, {figure.page.data_limit, places.of(figure.page)}) : PageData{});
    sizes.push_back(out.back().json.size());
  }
  std::ranges::sort(sizes);
  std::size_t room = kDataLimit;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const std::size_t share = room / (sizes.size() - i);
    if (sizes[i] <= share) {
      room -= sizes[i];
      continue;
    }
    for (std::size_t f = 0; f < out.size(); ++f) {
      const Page& large = page.figures[f].page;
      if (out[f].json.size() > share) out[f] = page_data(large, {share, places.of(large)});
    }
    break;
  }
  return out;
}

const ReproductionPage::Claim& claim_of(const ReproductionPage& page, const std::string& id) {
  return *std::ranges::find(page.claims, id, &ReproductionPage::Claim::id);
}

std::string claims_of(const ReproductionPage& page, const std::vector<std::string>& ids) {
  if (ids.empty()) return "";
  std::string out = "<ol class=\"claims\">\n";
  for (const auto& id : ids) out += claim_html(page, claim_of(page, id));
  return out + "</ol>\n";
}

std::string charts_of(const Figure& figure, const PageData& data) {
  const auto kinds = shown_charts(figure);
  if (kinds.empty()) return "";
  std::string out;
  for (const auto& kind : kinds) out += cat("<h3>", chart_title(kind), "</h3>\n", chart_html(figure.page, kind));
  for (const auto& sentence : data.left_out) out += cat("<p class=\"note\">", escaped(sentence), "</p>\n");
  return out + data_html(data.json);
}

Section figure_section(const ReproductionPage& page, const Figure& figure, const PageData& data) {
  const std::string says =
      figure.says.empty() ? "" : cat("<p class=\"paper-says\"><b>The paper:</b> ", escaped(figure.says), "</p>\n");
  const std::string trained =
      figure.trained.empty() ? "" : cat("<p class=\"note trained\">", escaped(figure.trained), "</p>\n");
  return {cat("figure-", escaped(figure.id)), escaped(figure.place), escaped(figure.title),
          cat(says, trained, claims_of(page, figure.claims), printed_table(figure), charts_of(figure, data)),
          cat(escaped(figure.place), page.label.empty() ? "" : " · <b class=\"partial\">not the full run</b>")};
}

/// Claims that no figure has.
std::vector<std::string> other_claims(const ReproductionPage& page) {
  std::set<std::string_view> taken;
  for (const auto& figure : page.figures) taken.insert(figure.claims.begin(), figure.claims.end());
  std::vector<std::string> out;
  for (const auto& claim : page.claims) {
    if (!taken.contains(claim.id)) out.push_back(claim.id);
  }
  return out;
}

std::string list_html(const char* style, std::span<const std::string> sentences) {
  std::string items;
  for (const auto& sentence : sentences) items += cat("<li>", escaped(sentence), "</li>\n");
  return items.empty() ? "" : cat("<ul class=\"", style, "\">\n", items, "</ul>\n");
}

std::string further_findings(const ReproductionPage& page) {
  const std::string list = list_html("further", page.findings);
  return list.empty() ? "" : cat("<h3>What else the data show</h3>\n", list);
}

std::vector<Section> sections(const ReproductionPage& page, const std::vector<PageData>& data) {
  std::vector<Section> out;
  out.push_back({"verdicts", "Verdicts", cat("What became of ", counted(page.claims.size(), "claim", "claims")),
                 cat(mark_shapes(), verdict_picture(page),
                     page.note.empty() ? "" : cat("<p class=\"note\">", escaped(page.note), "</p>\n"),
                     claims_by_reason_html(page), further_findings(page))});
  if (const std::string table = reading_table(page); !table.empty())
    out.push_back({"readings", "Readings", "What hangs on a reading", table});
  for (std::size_t i = 0; i < page.figures.size(); ++i) out.push_back(figure_section(page, page.figures[i], data[i]));
  if (const std::string claims = claims_of(page, other_claims(page)); !claims.empty())
    out.push_back({"claims", "Other claims", "Claims of no one figure", claims});
  Page origin;
  origin.provenance = page.provenance;
  origin.run_command = page.run_command;
  const std::string print =
      "<p class=\"print\"><button type=\"button\" id=\"print\" hidden>Draw all charts and print</button></p>\n";
  out.push_back({"provenance", "Provenance", "Where this comes from", provenance_html(origin) + print});
  return out;
}

std::string hero(const ReproductionPage& page) {
  const std::string label =
      page.label.empty() ? "" : cat("<p class=\"label-banner\" role=\"note\">", escaped(page.label), "</p>\n");
  const std::string facts = join(std::vector{counted(page.claims.size(), "claim", "claims"),
                                             counted(page.figures.size(), "figure and table", "figures and tables"),
                                             counted(page.readings.size(), "reading", "readings")},
                                 " · ");
  const std::span opening = page.opening;
  return cat(label, "<header class=\"hero\">\n<p class=\"over\">A paper’s reproduction</p>\n<h1>", escaped(page.title),
             "</h1>\n<p class=\"source\">", escaped(page.source), "</p>\n",
             opening.empty() ? "" : cat("<p class=\"question\">", escaped(opening.front()), "</p>\n"),
             opening.empty() ? "" : list_html("further", opening.subspan(1)), "<p class=\"facts-line\">", facts,
             "</p>\n</header>\n", warnings_html(page.warnings));
}

}  // namespace

std::string render_reproduction(const ReproductionPage& page) {
  check_reproduction(page);
  Document document;
  document.name = page.title;
  document.places = Places(page).count(page);
  document.style =
      cat(asset("reproduction.css"), page.label.empty() ? "" : ".topbar { border-bottom: 3px solid var(--open); }\n");
  document.hero = hero(page);
  document.sections = sections(page, figure_data(page));
  return document_html(document);
}

}  // namespace gust
