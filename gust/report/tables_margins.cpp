#include <algorithm>
#include <cmath>
#include <map>

#include "gust/core/error.h"
#include "gust/report/answer.h"
#include "gust/report/html.h"
#include "gust/report/tables.h"

namespace gust {
namespace {

constexpr std::size_t kMostRows = 400;

using Row = std::vector<const Page::Margin*>;   // by policy; null where there is none
using MarginRows = std::map<std::size_t, Row>;  // by sweep

MarginRows rows_of(const Page& page, std::size_t start) {
  MarginRows rows;
  for (const auto& margin : page.margins) {
    if (margin.start != start) continue;
    Row& row = rows[margin.sweep];
    row.resize(page.policies.size(), nullptr);
    row[margin.policy] = &margin;
  }
  return rows;
}

/// Where the drawn axis of a row ends: at the last level, or further if a margin lies there.
double axis_end(const Page::Sweep& sweep, const Row& row) {
  double end = sweep.levels.empty() ? 0 : sweep.levels.back();
  for (const auto* margin : row) {
    if (!margin) continue;
    for (const double value : {margin->level.value, margin->level.high}) {
      if (std::isfinite(value)) end = std::max(end, value);
    }
  }
  return end;
}

std::string place(double value, double end) {
  const double share = end > 0 && std::isfinite(value) ? std::clamp(value / end, 0.0, 1.0) : 1.0;
  return format("{:.1f}%", 100 * share);
}

/// The interval as a bar, the estimate as a tick; an arrow where the grid ended first.
std::string micro_plot(const Page::Margin& margin, double end) {
  const Page::Estimate& level = margin.level;
  const std::string x = place(level.value, end);
  std::string marks = cat("<line class=\"axis\" x1=\"0\" x2=\"100%\" y1=\"6\" y2=\"6\"/>");
  if (!std::isnan(level.low) && !std::isnan(level.high)) {
    marks += cat("<line class=\"bar\" x1=\"", place(level.low, end), "\" x2=\"", place(level.high, end),
                 "\" y1=\"6\" y2=\"6\"/>");
  }
  marks += margin.censored
               ? cat("<svg x=\"", x, "\" overflow=\"visible\"><path class=\"beyond\" d=\"M-6 2 L-1 6 L-6 10\"/></svg>")
               : cat("<line class=\"tick\" x1=\"", x, "\" x2=\"", x, "\" y1=\"1\" y2=\"11\"/>");
  return cat("<svg class=\"micro\" height=\"12\" aria-hidden=\"true\">", marks, "</svg>");
}

/// The same margin from the other starts, small.
std::string from_other_starts(const Page& page, const Page::Margin& margin) {
  std::string out;
  for (const auto& other : page.margins) {
    if (other.sweep != margin.sweep || other.policy != margin.policy || other.start == margin.start) continue;
    out += cat("<small class=\"beside\">", escaped(page.starts[other.start].name), " ",
               escaped(margin_words(other).value), "</small>");
  }
  return out;
}

std::string cell(const Page& page, const Page::Margin* margin, double end, bool ahead) {
  if (!margin) return "<td class=\"missing\">–</td>";
  const auto [value, interval] = margin_words(*margin);
  const std::string reason = margin->reason.empty() ? "" : cat("<small>", escaped(margin->reason), "</small>");
  return cat("<td data-policy=\"", margin->policy, "\"", ahead ? " class=\"ahead\"" : "", "><span class=\"value\">",
             escaped(value), "</span> <span class=\"interval\">", escaped(interval), "</span>", reason,
             std::isnan(margin->level.value) ? "" : micro_plot(*margin, end), from_other_starts(page, *margin),
             "</td>");
}

std::string row_html(const Page& page, std::size_t start, std::size_t sweep_index, const Row& row) {
  const auto& sweep = page.sweeps[sweep_index];
  const double end = axis_end(sweep, row);
  const std::size_t winner = clear_winner(page, sweep_index, start);
  std::string out = cat("<tr><th scope=\"row\">", escaped(sweep.name), " <span class=\"range\">to ", short_number(end),
                        unit_html(sweep.unit), "</span></th>");
  for (std::size_t p = 0; p < row.size(); ++p) out += cell(page, row[p], end, p == winner);
  return out + "</tr>\n";
}

std::string head_html(const Page& page, std::size_t start) {
  std::string out = "<thead><tr><th scope=\"col\">disturbance</th>";
  for (std::size_t p = 0; p < page.policies.size(); ++p) {
    const auto& policy = page.policies[p];
    const std::string seeds = policy.seeds > 1 ? cat(", ", policy.seeds, " seeds") : "";
    const double score = undisturbed(page, p, start);
    const std::string nominal = std::isnan(score) ? "" : cat("<small>", short_number(score), " undisturbed</small>");
    out += cat("<th scope=\"col\" data-policy=\"", p, "\"><span class=\"key\" data-policy=\"", p, "\"></span>",
               escaped(policy.name), "<small>", escaped(policy.kind), seeds, "</small>", nominal, "</th>");
  }
  return out + "</tr></thead>\n";
}

std::string group_name(const Page::Sweep& sweep) { return sweep.site.empty() ? "parameters" : sweep.site; }

std::string table_html(const Page& page, std::size_t start, const MarginRows& rows) {
  std::vector<std::string> groups;
  std::map<std::string, std::string> bodies;
  std::size_t shown = 0;
  for (const auto& [sweep, row] : rows) {
    const std::string group = group_name(page.sweeps[sweep]);
    if (!bodies.contains(group)) groups.push_back(group);
    std::string& body = bodies[group];
    if (++shown <= kMostRows) body += row_html(page, start, sweep, row);
  }
  std::string out = cat("<div class=\"scroll margins by-start\" data-start=\"", start,
                        "\" tabindex=\"0\" role=\"region\" aria-label=\"Margins, ", escaped(page.starts[start].title),
                        "\"><table style=\"--policies:", page.policies.size(), "\">\n", head_html(page, start));
  for (const auto& group : groups) {
    out += cat("<tbody><tr class=\"group\"><th colspan=\"", page.policies.size() + 1, "\" scope=\"rowgroup\">",
               escaped(group), "</th></tr>\n", bodies[group], "</tbody>\n");
  }
  out += "</table></div>\n";
  if (shown > kMostRows)
    out += cat("<p class=\"note\">", shown - kMostRows, " rows more are in the exported data.</p>\n");
  return out;
}

}  // namespace

std::string margins_table(const Page& page) {
  std::string out;
  for (std::size_t start = 0; start < page.starts.size(); ++start) {
    const MarginRows rows = rows_of(page, start);
    if (!rows.empty()) out += table_html(page, start, rows);
  }
  return out;
}

}  // namespace gust
