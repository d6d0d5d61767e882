#include <algorithm>
#include <cmath>
#include <span>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/report/html.h"
#include "gust/report/tables.h"

namespace gust {
namespace {

using Comparison = Page::Comparison;
using Pair = std::span<const Comparison>;

std::string policy_html(const Page& page, std::size_t policy) {
  return cat("<b class=\"policy\" data-policy=\"", policy, "\">", escaped(page.policies[policy].name), "</b>");
}

/// The policy that is ahead; kNone where that is undecided.
std::size_t leader(const Comparison& item, Standing standing) {
  if (standing == Standing::undecided) return Page::kNone;
  return standing == Standing::ahead ? item.a : item.b;
}

std::string verdict_html(const Page& page, const Comparison& item) {
  const std::size_t first = leader(item, item.standing);
  const std::string needed = item.needed.empty() ? "" : cat("<small>", escaped(item.needed), "</small>");
  return cat(first == Page::kNone ? "undecided" : policy_html(page, first), needed);
}

std::string estimate_html(const Page::Estimate& estimate, double scale) {
  return cat("<span class=\"value\">", decimal(estimate.value, scale), "</span> <span class=\"interval\">",
             interval_text(estimate, scale), "</span>");
}

/// "≥ 2.1", "≤ 0.5", "2.1 [1.8, 2.4]"
std::string ratio_html(const Comparison& item) {
  if (std::isnan(item.ratio.value)) return "<span class=\"missing\">–</span>";
  if (std::isnan(item.ratio_most)) return estimate_html(item.ratio, item.ratio.value);
  if (item.ratio.value > 0 && std::isinf(item.ratio_most)) return cat("≥&nbsp;", short_number(item.ratio.value));
  if (item.ratio.value == 0 && std::isfinite(item.ratio_most)) return cat("≤&nbsp;", short_number(item.ratio_most));
  return "<span class=\"missing\">both beyond the levels</span>";
}

/// "83 % [71, 92]"
std::string share_html(const Page::Estimate& share) {
  const std::string ends =
      std::isnan(share.low) ? "" : fmt::format("[{:.0f}, {:.0f}]", 100 * share.low, 100 * share.high);
  return cat("<span class=\"value\">", percent(share.value), "</span> <span class=\"interval\">", ends, "</span>");
}

/// Who is ahead from the first level to the last, as a bar in their colours.
std::string strip_html(const Comparison& item) {
  if (item.levels.size() < 2) return "";
  std::string parts;
  const double width = 100.0 / static_cast<double>(item.levels.size());
  for (std::size_t from = 0, end = 0; from < item.levels.size(); from = end) {
    while (end < item.levels.size() && item.levels[end] == item.levels[from]) ++end;
    const std::size_t first = leader(item, item.levels[from]);
    const std::string colour = first == Page::kNone ? " class=\"open\"" : cat(" data-policy=\"", first, "\"");
    parts += cat("<rect", colour,
                 fmt::format(" x=\"{:.1f}%\" width=\"{:.1f}%\" height=\"10\"/>", width * from, width * (end - from)));
  }
  const auto count = [&](Standing wanted) { return std::ranges::count(item.levels, wanted); };
  return cat("<svg class=\"strip\" height=\"10\" role=\"img\" aria-label=\"ahead at ", count(Standing::ahead),
             ", behind at ", count(Standing::behind), ", undecided at ", count(Standing::undecided), " of ",
             item.levels.size(), " levels\">", parts, "</svg>");
}

std::string row_html(const Page& page, const Comparison& item) {
  return cat("<tr><th scope=\"row\">", escaped(item.name), "</th><td>", verdict_html(page, item), "</td><td>",
             estimate_html(item.difference, 1), "</td><td>", ratio_html(item), "</td><td>",
             share_html(item.improvement), "</td><td>", strip_html(item), "</td></tr>\n");
}

std::string pair_html(const Page& page, Pair pair, bool open) {
  const Comparison& any = pair.front();
  const auto count = [&](Standing wanted) { return std::ranges::count(pair, wanted, &Comparison::standing); };
  std::string out =
      cat("<details class=\"pair\"", open ? " open" : "", "><summary>", policy_html(page, any.a), " against ",
          policy_html(page, any.b), " <small>ahead in ", count(Standing::ahead), ", behind in ",
          count(Standing::behind), ", undecided in ", count(Standing::undecided), "</small></summary>\n",
          "<div class=\"scroll compared\" tabindex=\"0\" role=\"region\" aria-label=\"Comparison of ",
          escaped(page.policies[any.a].name), " with ", escaped(page.policies[any.b].name),
          "\"><table>\n<thead><tr><th scope=\"col\">sweep</th><th scope=\"col\">ahead</th><th "
          "scope=\"col\">difference</th><th scope=\"col\">ratio of margins</th><th scope=\"col\">scores "
          "higher</th><th scope=\"col\">by level</th></tr></thead>\n<tbody>\n");
  for (const Comparison& item : pair) out += row_html(page, item);
  return out + "</tbody></table></div></details>\n";
}

}  // namespace

std::string comparisons_html(const Page& page) {
  std::string out;
  const std::vector<Comparison>& all = page.comparisons;
  for (std::size_t from = 0, end = 0; from < all.size(); from = end) {
    while (end < all.size() && all[end].a == all[from].a && all[end].b == all[from].b) ++end;
    out += pair_html(page, Pair(all).subspan(from, end - from), from == 0);
  }
  return out;
}

}  // namespace gust
