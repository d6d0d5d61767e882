#include "gust/report/document.h"

#include <array>
#include <map>

#include "gust/core/error.h"
#include "gust/core/version.h"
#include "gust/report/assets.h"
#include "gust/report/html.h"

namespace gust {
namespace {

constexpr std::array kLibraries = {"vega.js", "vega-lite.js", "vega-embed.js"};

/// In the order in which they run; they share one scope.
constexpr std::array kScripts = {"elements.js", "theme.js", "specs.js",    "tooltip.js",   "chart.js",
                                 "export.js",   "scene.js", "cartpole.js", "quadrotor.js", "plots.js"};

/// The body of startFigures(root, data), which runs once for each dataset.
constexpr std::array kFigureScripts = {"data.js", "figure.js",       "curves.js", "learning.js",
                                       "heat.js", "disturbances.js", "replay.js", "begin.js"};

constexpr std::size_t kColours = 8;  // --p0 … --p7 in page.css

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

std::string style(const Document& document) {
  constexpr std::string_view kLatin =
      "U+0000-00FF,U+0131,U+0152-0153,U+02BB-02BC,U+02C6,U+02DA,U+02DC,U+2000-206F,U+20AC,U+2122,U+2191,U+2193,U+2212,"
      "U+2215,U+FEFF,U+FFFD";
  std::string out = font_face("Inter", "inter-latin.woff2", kLatin) +
                    font_face("Inter", "inter-greek.woff2", "U+0370-03FF") +
                    font_face("Source Serif 4", "serif-latin.woff2", kLatin);
  out += cat(asset("page.css"), document.style);
  for (std::size_t place = 0; place < document.places; ++place) {
    out += cat("[data-policy=\"", place, "\"]{--policy:var(--p", place % kColours, ")}\n");
  }
  return out;
}

std::string scripts() {
  std::string out;
  for (const auto* name : kLibraries) out += cat("<script>", asset(name), "</script>\n");
  out += "<script>(() => {\n'use strict';\n";
  for (const auto* name : kScripts) out += asset(name);
  out += "function startFigures(root, data) {\n";
  for (const auto* name : kFigureScripts) out += asset(name);
  return cat(out, "}\n", asset("main.js"), "})();</script>");
}

}  // namespace

std::string document_html(const Document& document) {
  GUST_CHECK(!document.sections.empty());
  std::string links;
  std::string body;
  for (const auto& [id, link, title, content, over] : document.sections) {
    links += cat("<a href=\"#", id, "\">", link, "</a>");
    body += cat("<section id=\"", id, "\">", over.empty() ? "" : cat("<p class=\"over\">", over, "</p>\n"), "<h2>",
                title, "</h2>\n", content, "</section>\n");
  }
  return filled(asset("page.html"), {{"version", std::string(kVersion)},
                                     {"name", escaped(document.name)},
                                     {"style", style(document)},
                                     {"early", std::string(asset("early.js"))},
                                     {"first", document.sections.front().id},
                                     {"links", links},
                                     {"hero", document.hero},
                                     {"sections", body},
                                     {"licences", escaped(asset("licences.txt"))},
                                     {"data", document.data},
                                     {"scripts", scripts()}});
}

std::string data_html(std::string_view json, std::string_view id) {
  return cat("<script type=\"application/json\"", id.empty() ? "" : cat(" id=\"", id, "\""), ">", json, "</script>\n");
}

std::string list_html(std::span<const std::string> sentences, std::string_view kind) {
  std::string out = cat("<ul class=\"", kind, "\">\n");
  for (const auto& sentence : sentences) out += cat("<li>", sentence, "</li>\n");
  return out + "</ul>\n";
}

std::string warnings_html(std::span<const std::string> warnings) {
  std::string out;
  for (const auto& warning : warnings) out += cat("<p class=\"warning\" role=\"note\">", escaped(warning), "</p>\n");
  return out;
}

}  // namespace gust
