#include "gust/report/charts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/report/html.h"

namespace gust {
namespace {

constexpr std::array<std::string_view, 7> kKinds = {"curves", "survival",     "learning", "parameters",
                                                    "grids",  "disturbances", "replay"};

bool has_curves(const Page& page, bool of_sites, std::size_t metric) {
  return std::ranges::any_of(page.curves, [&](const Page::Curve& curve) {
    return page.sweeps[curve.sweep].site.empty() != of_sites && (metric == Page::kNone || curve.metric == metric);
  });
}

bool is_limited(const Page::Sweep& sweep) {
  return std::isfinite(sweep.possible_low) || std::isfinite(sweep.possible_high);
}

std::string caption(const Page& page, std::string_view kind) {
  if (kind == "curves") {
    return cat(
        "One column a site, one row a waveform. Line: estimate; band: ", escaped(page.interval),
        page.margins.empty() ? "." : ". Triangles on the axis: margins.",
        page.saturation_metric == Page::kNone ? "" : " Strip beneath: share of control steps with a saturated action.");
  }
  if (kind == "survival") return "Share of episodes that end without a failure; band: 95 % Wilson interval.";
  if (kind == "learning") {
    std::vector<std::string> others;
    for (const auto& learning : page.learning) {
      const std::string source = escaped(learning.source);
      if (!source.empty() && std::ranges::find(others, source) == others.end()) others.push_back(source);
    }
    return cat("Thin: one training seed. Thick: their mean, with its interval.",
               others.empty() ? "" : cat(" Grey, dashed: ", join(others, "; "), "."));
  }
  if (kind == "parameters") {
    return cat("The dotted line marks the value the policies were made for.",
               std::ranges::any_of(page.sweeps, is_limited) ? " Shaded: no policy can hold the plant there." : "");
  }
  if (kind == "grids") return "Two parameters at once, one map a policy.";
  if (kind == "disturbances")
    return "What was injected into a kept episode of each sweep, held over each control step.";
  return "Space plays, ← → step (with Shift: ten), [ ] change the speed, Home and End jump.";
}

}  // namespace

std::span<const std::string_view> chart_kinds() { return kKinds; }

bool has_chart(const Page& page, std::string_view kind) {
  if (kind == "curves") return has_curves(page, true, Page::kNone);
  if (kind == "survival") return page.survival_metric != Page::kNone && has_curves(page, true, page.survival_metric);
  if (kind == "learning") return !page.learning.empty();
  if (kind == "parameters") return has_curves(page, false, Page::kNone);
  if (kind == "grids") return !page.grids.empty();
  if (kind == "disturbances") {
    return std::ranges::any_of(page.episodes, [](const Page::Episode& episode) {
      return episode.sweep != Page::kNone && !episode.disturbances.empty();
    });
  }
  if (kind == "replay") return !page.episodes.empty();
  throw Bug(cat("no chart is called '", kind, "'"));
}

std::string_view chart_title(std::string_view kind) {
  if (kind == "curves") return "Score against disturbance";
  if (kind == "survival") return "Who is still standing";
  if (kind == "learning") return "How the policies learned";
  if (kind == "parameters") return "A different plant";
  if (kind == "grids") return "Two parameters at once";
  if (kind == "disturbances") return "What was injected";
  return "Watch it";
}

std::string chart_html(const Page& page, std::string_view kind, std::string_view id) {
  return cat("<figure class=\"figure\" data-figure=\"", kind, "\"", id.empty() ? "" : cat(" id=\"", id, "\""),
             "><div class=\"body\"></div><figcaption>", caption(page, kind), "</figcaption></figure>\n");
}

}  // namespace gust
