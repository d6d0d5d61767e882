#include "gust/report/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/core/version.h"
#include "gust/report/answer.h"
#include "gust/report/assets.h"
#include "gust/report/check_page.h"
#include "gust/report/html.h"
#include "gust/report/page_data.h"
#include "gust/report/tables.h"

namespace gust {
namespace {

constexpr std::array kLibraries = {"vega.js", "vega-lite.js", "vega-embed.js"};

/// In the order in which they run; they share one scope.
constexpr std::array kScripts = {"data.js",      "theme.js",  "specs.js",    "tooltip.js", "chart.js", "export.js",
                                 "figure.js",    "curves.js", "learning.js", "heat.js",    "scene.js", "cartpole.js",
                                 "quadrotor.js", "plots.js",  "replay.js",   "main.js"};

constexpr std::size_t kColours = 8;  // --p0 … --p7 in page.css

struct Section {
  std::string id;
  std::string link;  // in the bar
  std::string title;
  std::string body;
};

/// Replaces each {{key}} of a template once; what is put in is not looked at again.
std::string filled(std::string_view text, const std::map<std::string_view, std::string>& values) {
  std::string out;
  while (true) {
    const std::size_t from = text.find("{{");
    out += text.substr(0, from);
    if (from == std::string_view::npos) return out;
    const std::size_t to = text.find("}}", from);
    GUST_CHECK(to != std::string_view::npos);
    out += values.at(text.substr(from + 2, to - from - 2));
    text.remove_prefix(to + 2);
  }
}

std::string font_face(std::string_view family, std::string_view file, std::string_view range) {
  return cat("@font-face{font-family:\"", family, "\";font-weight:200 900;font-display:swap;unicode-range:", range,
             ";src:url(data:font/woff2;base64,", base64(asset(file)), ") format(\"woff2\")}\n");
}

std::string style(const Page& page) {
  constexpr std::string_view kLatin =
      "U+0000-00FF,U+0131,U+0152-0153,U+02BB-02BC,U+02C6,U+02DA,U+02DC,U+2000-206F,U+20AC,U+2122,U+2191,U+2193,U+2212,"
      "U+2215,U+FEFF,U+FFFD";
  std::string out = font_face("Inter", "inter-latin.woff2", kLatin) +
                    font_face("Inter", "inter-greek.woff2", "U+0370-03FF") +
                    font_face("Source Serif 4", "serif-latin.woff2", kLatin);
  out += asset("page.css");
  for (std::size_t p = 0; p < page.policies.size(); ++p) {
    out += cat("[data-policy=\"", p, "\"]{--policy:var(--p", p % kColours, ")}\n");
  }
  return out;
}

std::string scripts() {
  std::string out;
  for (const auto* name : kLibraries) out += cat("<script>", asset(name), "</script>\n");
  out += "<script>(() => {\n'use strict';\n";
  for (const auto* name : kScripts) out += asset(name);
  return out + "})();</script>";
}

std::string list_html(const std::vector<std::string>& sentences, std::string_view kind) {
  std::string out = cat("<ul class=\"", kind, "\">\n");
  for (const auto& sentence : sentences) out += cat("<li>", sentence, "</li>\n");
  return out + "</ul>\n";
}

std::string figure(std::string_view id, std::string_view caption) {
  return cat("<figure class=\"figure\" id=\"figure-", id, "\"><div class=\"body\"></div><figcaption>", caption,
             "</figcaption></figure>\n");
}

std::string answer_section(const Page& page, const std::vector<std::string>& left_out) {
  auto confidence = confidence_html(page);
  for (const auto& sentence : left_out) confidence.push_back(escaped(sentence));
  std::string out = cat("<div class=\"columns\"><div>", list_html(answer_html(page), "says"),
                        "</div><aside><h3>How sure we are</h3>\n", list_html(confidence, "notes"), "</aside></div>\n");
  if (const std::string table = margins_table(page); !table.empty()) {
    out += cat("<h3 id=\"margins\">Robustness margins</h3>\n<p class=\"lead\">The first level at which ",
               escaped(page.metrics[page.margin_metric].title), " falls below ",
               fmt::format("{:.0f} %", 100 * page.margin_share),
               " of its undisturbed value. Bar: interval, on the scale of its row. <b class=\"ahead\">Bold</b>: "
               "clearly ahead of all others; who undisturbed scores less than that share of the best is left "
               "out.</p>\n<div class=\"choices\" id=\"margin-choices\"></div>\n",
               table);
  }
  if (const std::string table = worst_table(page); !table.empty()) {
    out += cat("<h3 id=\"worst\">Worst cells</h3>\n<p class=\"lead\">Where ",
               escaped(page.metrics.empty() ? "the score" : page.metrics[0].title), " is lowest.</p>\n", table);
  }
  return out;
}

bool has_curves(const Page& page, bool of_sites, std::size_t metric) {
  return std::any_of(page.curves.begin(), page.curves.end(), [&](const Page::Curve& curve) {
    return page.sweeps[curve.sweep].site.empty() != of_sites && (metric == Page::kNone || curve.metric == metric);
  });
}

std::vector<Section> sections(const Page& page, const std::vector<std::string>& left_out) {
  std::vector<Section> out;
  out.push_back({"answer", "Answer", "The answer", answer_section(page, left_out)});
  if (has_curves(page, true, Page::kNone)) {
    const std::string strip =
        page.saturation_metric == Page::kNone ? "" : " Strip beneath: share of control steps with a saturated action.";
    out.push_back({"curves", "Curves", "Score against disturbance",
                   figure("curves", cat("One column a site, one row a waveform. Line: estimate; band: ",
                                        escaped(page.interval), ". Triangles on the axis: margins.", strip))});
  }
  if (page.survival_metric != Page::kNone && has_curves(page, true, page.survival_metric)) {
    out.push_back({"survival", "Survival", "Who is still standing",
                   figure("survival", "Share of episodes that end without a failure; band: 95 % Wilson interval.")});
  }
  if (!page.learning.empty()) {
    out.push_back(
        {"learning", "Learning", "How the policies learned",
         figure("learning",
                "Thin: one training seed. Thick: their mean, with its interval. Grey, dashed: another source.")});
  }
  if (has_curves(page, false, Page::kNone) || !page.grids.empty()) {
    std::string body;
    const bool limited = std::ranges::any_of(page.sweeps, [](const Page::Sweep& sweep) {
      return std::isfinite(sweep.possible_low) || std::isfinite(sweep.possible_high);
    });
    if (has_curves(page, false, Page::kNone))
      body += figure("parameters", cat("The dotted line marks the value the policies were made for.",
                                       limited ? " Shaded: no policy can hold the plant there." : ""));
    if (!page.grids.empty()) body += figure("grids", "Two parameters at once, one map a policy.");
    out.push_back({"parameters", "Parameters", "A different plant", body});
  }
  if (!page.episodes.empty()) {
    out.push_back(
        {"replay", "Replay", "Watch it",
         figure("replay", "Space plays, ← → step (with Shift: ten), [ ] change the speed, Home and End jump.")});
  }
  if (const std::string claims = claims_list(page); !claims.empty())
    out.push_back({"claims", "Claims", "Claims", claims});
  out.push_back({"provenance", "Provenance", "Where this comes from", provenance_html(page)});
  return out;
}

std::string facts_line(const Page& page) {
  const auto count = [](std::size_t n, std::string_view one, std::string_view many) {
    return cat(n, " ", n == 1 ? one : many);
  };
  std::vector<std::string> parts = {count(page.policies.size(), "policy", "policies"),
                                    count(page.sweeps.size(), "sweep", "sweeps")};
  if (!page.episodes.empty()) parts.push_back(count(page.episodes.size(), "kept episode", "kept episodes"));
  if (!page.claims.empty()) {
    const auto held = std::count_if(page.claims.begin(), page.claims.end(),
                                    [](const auto& c) { return c.verdict == Page::Verdict::kHolds; });
    parts.push_back(cat(held, " of ", count(page.claims.size(), "claim holds", "claims hold")));
  }
  return join(parts, " · ");
}

std::string warnings_html(const Page& page) {
  std::string out;
  for (const auto& warning : page.warnings)
    out += cat("<p class=\"warning\" role=\"note\">", escaped(warning), "</p>\n");
  return out;
}

}  // namespace

std::string render_page(const Page& page) {
  check_page(page);
  const PageData data = page_data(page);
  std::string links;
  std::string body;
  for (const auto& [id, link, title, content] : sections(page, data.left_out)) {
    links += cat("<a href=\"#", id, "\">", link, "</a>");
    body += cat("<section id=\"", id, "\"><h2>", title, "</h2>\n", content, "</section>\n");
  }
  return filled(asset("page.html"), {{"version", std::string(kVersion)},
                                     {"name", escaped(page.name)},
                                     {"style", style(page)},
                                     {"early", std::string(asset("early.js"))},
                                     {"links", links},
                                     {"plant", page.plant.empty() ? "" : cat(" · ", escaped(page.plant))},
                                     {"question", escaped(page.question)},
                                     {"facts", facts_line(page)},
                                     {"warnings", warnings_html(page)},
                                     {"sections", body},
                                     {"licences", escaped(asset("licences.txt"))},
                                     {"data", data.json},
                                     {"scripts", scripts()}});
}

}  // namespace gust
