#include "gust/report/answer.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/report/html.h"
#include "gust/stats/margin.h"

namespace gust {
namespace {

std::string policy_html(const Page& page, std::size_t policy) {
  return cat("<b class=\"policy\" data-policy=\"", policy, "\">", escaped(page.policies[policy].name), "</b>");
}

std::string percent(double share) { return format("{:.0f} %", 100 * share); }

/// The policy with the greatest undisturbed score; kNone where none is known.
std::size_t best_undisturbed(const Page& page, std::size_t start) {
  std::size_t best = Page::kNone;
  for (std::size_t p = 0; p < page.policies.size(); ++p) {
    const double score = undisturbed(page, p, start);
    if (!std::isnan(score) && (best == Page::kNone || score > undisturbed(page, best, start))) best = p;
  }
  return best;
}

/// The policies whose undisturbed score is so far from the best that their margins do not compare.
std::vector<std::size_t> short_of_best(const Page& page, std::size_t start) {
  std::vector<std::size_t> out;
  const std::size_t best = best_undisturbed(page, start);
  for (std::size_t p = 0; best != Page::kNone && p < page.policies.size(); ++p) {
    const MarginRule rule{.fraction = page.margin_share};
    if (falls_short(undisturbed(page, p, start), undisturbed(page, best, start), rule)) out.push_back(p);
  }
  return out;
}

/// The margins of a sweep that compare.
std::vector<const Page::Margin*> margins_of(const Page& page, std::size_t sweep, std::size_t start) {
  std::vector<const Page::Margin*> out;
  const std::vector<std::size_t> left_out = short_of_best(page, start);
  for (const auto& margin : page.margins) {
    const bool compares = std::ranges::find(left_out, margin.policy) == left_out.end();
    if (margin.sweep == sweep && margin.start == start && compares && !std::isnan(margin.level.value))
      out.push_back(&margin);
  }
  return out;
}

double low_end(const Page::Margin& margin) {
  return std::isnan(margin.level.low) ? margin.level.value : margin.level.low;
}

double high_end(const Page::Margin& margin) {
  if (margin.censored) return std::numeric_limits<double>::infinity();
  return std::isnan(margin.level.high) ? margin.level.value : margin.level.high;
}

/// Whether the margin of one policy is ahead of another's by their ratio on the same episodes; none where they were not
/// compared.
std::optional<bool> ahead_in_pairs(const Page& page, const Page::Margin& one, const Page::Margin& other) {
  for (const auto& pair : page.comparisons) {
    if (pair.sweep != one.sweep || pair.start != one.start || std::isnan(pair.ratio.low)) continue;
    if (pair.a == one.policy && pair.b == other.policy) return !pair.few_seeds && pair.ratio.low > 1.0;
    if (pair.b == one.policy && pair.a == other.policy) return !pair.few_seeds && pair.ratio.high < 1.0;
  }
  return std::nullopt;
}

/// Sites in the order of the study.
std::vector<std::string> sites_of(const Page& page) {
  std::vector<std::string> sites;
  for (const auto& sweep : page.sweeps) {
    if (!sweep.site.empty() && std::find(sites.begin(), sites.end(), sweep.site) == sites.end()) {
      sites.push_back(sweep.site);
    }
  }
  return sites;
}

/// "ppo tolerates the most under 9 of 15 disturbances, lqr under 3; under 3 no policy is clearly ahead."
std::string ranking(const Page& page, std::size_t start) {
  std::vector<std::size_t> wins(page.policies.size(), 0);
  std::size_t compared = 0;
  for (std::size_t s = 0; s < page.sweeps.size(); ++s) {
    if (page.sweeps[s].site.empty() || margins_of(page, s, start).size() < 2) continue;
    ++compared;
    const std::size_t winner = clear_winner(page, s, start);
    if (winner != Page::kNone) ++wins[winner];
  }
  if (compared == 0) return "";
  std::vector<std::size_t> order;
  std::size_t decided = 0;
  for (std::size_t p = 0; p < wins.size(); ++p) {
    if (wins[p] > 0) order.push_back(p);
    decided += wins[p];
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return wins[a] > wins[b]; });
  std::vector<std::string> parts;
  for (const std::size_t p : order) {
    const std::string holds = parts.empty() ? cat(" tolerates the most under ", wins[p], " of ",
                                                  counted(compared, "disturbance", "disturbances"))
                                            : cat(" under ", wins[p]);
    parts.push_back(policy_html(page, p) + holds);
  }
  if (decided == 0)
    return cat("Under none of ", counted(compared, "disturbance", "disturbances"), " is one policy clearly ahead.");
  const std::size_t open = compared - decided;
  const std::string rest = open > 0 ? cat("; under ", open, " no policy is clearly ahead") : "";
  return cat(join(parts, ", "), rest, ".");
}

/// "ppo (0.31) is not ranked: undisturbed it scores less than 90 % of the best, lqr (0.98); a margin is a fall from a
/// policy's own score."
std::string not_ranked(const Page& page, std::size_t start) {
  const std::size_t best = best_undisturbed(page, start);
  const auto scored = [&](std::size_t policy) {
    return cat(policy_html(page, policy), " (", short_number(undisturbed(page, policy, start)), ")");
  };
  std::vector<std::string> parts;
  for (const std::size_t policy : short_of_best(page, start)) parts.push_back(scored(policy));
  if (parts.empty()) return "";
  const bool one = parts.size() == 1;
  return cat(join(parts, ", "), one ? " is" : " are", " not ranked: undisturbed ", one ? "it scores" : "they score",
             " less than ", percent(page.margin_share), " of the best, ", scored(best),
             "; a margin is a fall from a policy’s own score.");
}

/// The smallest margin on each site: "On the action site the first to fall is ppo, under "a step" at 11.8 N."
std::string first_to_fall(const Page& page, const std::string& site, std::size_t start) {
  const Page::Margin* first = nullptr;
  std::size_t asked = 0, known = 0;
  for (const auto& margin : page.margins) {
    if (margin.start != start || page.sweeps[margin.sweep].site != site) continue;
    ++asked;
    if (std::isnan(margin.level.value)) continue;
    ++known;
    if (!margin.censored && (!first || margin.level.value < first->level.value)) first = &margin;
  }
  if (asked > 0 && known == 0) return cat("On the <b>", escaped(site), "</b> site no policy has a margin.");
  if (!first)
    return cat("On the <b>", escaped(site), "</b> site nothing on the grid costs more than ",
               percent(1 - page.margin_share), " of the score.");
  return cat("On the <b>", escaped(site), "</b> site the first to fall is ", policy_html(page, first->policy),
             ", under ", escaped(page.sweeps[first->sweep].name), " at ", margin_html(page, *first), ".");
}

}  // namespace

double undisturbed(const Page& page, std::size_t policy, std::size_t start) {
  const auto at = std::ranges::find_if(
      page.margins, [&](const Page::Margin& margin) { return margin.policy == policy && margin.start == start; });
  return at == page.margins.end() ? Page::kUnknown : at->nominal;
}

MarginWords margin_words(const Page::Margin& margin) {
  const std::size_t end = margin.text.find(" [");
  return {margin.text.substr(0, end), end == std::string::npos ? "" : margin.text.substr(end + 1)};
}

std::string margin_html(const Page& page, const Page::Margin& margin) {
  const auto [value, interval] = margin_words(margin);
  const std::string& unit = page.sweeps[margin.sweep].unit;
  const bool number = !value.empty() && value.back() >= '0' && value.back() <= '9';
  return cat(escaped(value), number ? unit_html(unit) : "",
             interval.empty() ? "" : cat(" <span class=\"interval\">", escaped(interval), "</span>"));
}

std::size_t clear_winner(const Page& page, std::size_t sweep, std::size_t start) {
  const auto margins = margins_of(page, sweep, start);
  if (margins.size() < 2) return Page::kNone;
  for (const auto* one : margins) {
    const bool ahead = std::all_of(margins.begin(), margins.end(), [&](const Page::Margin* other) {
      if (other == one) return true;
      return ahead_in_pairs(page, *one, *other).value_or(low_end(*one) > high_end(*other));
    });
    if (ahead) return one->policy;
  }
  return Page::kNone;
}

std::vector<std::string> answer_html(const Page& page, std::size_t start) {
  std::vector<std::string> out;
  const bool any = std::ranges::any_of(page.margins, [&](const auto& margin) { return margin.start == start; });
  if (!any) return out;
  if (const std::string sentence = ranking(page, start); !sentence.empty()) out.push_back(sentence);
  if (const std::string sentence = not_ranked(page, start); !sentence.empty()) out.push_back(sentence);
  for (const auto& site : sites_of(page)) out.push_back(first_to_fall(page, site, start));
  return out;
}

std::vector<std::string> confidence_html(const Page& page) {
  std::vector<std::string> out;
  for (const auto& sentence : page.confidence) out.push_back(escaped(sentence));
  out.push_back(cat("Intervals: ", escaped(page.interval), "."));
  std::vector<std::string> single;
  for (std::size_t p = 0; p < page.policies.size(); ++p) {
    if (page.policies[p].seeds < 2) single.push_back(policy_html(page, p));
  }
  if (!single.empty() && single.size() < page.policies.size()) {
    const bool one = single.size() == 1;
    out.push_back(cat(join(single, ", "),
                      one ? " has one seed: its interval, if any, is" : " have one seed: their intervals, if any, are",
                      " over episodes, not over trainings."));
  }
  const auto censored =
      std::count_if(page.margins.begin(), page.margins.end(), [](const auto& m) { return m.censored; });
  if (censored > 0) {
    out.push_back(cat(censored, " of ", page.margins.size(), censored == 1 ? " margins lies" : " margins lie",
                      " beyond the levels tried: read “≥” as “at least”."));
  }
  return out;
}

}  // namespace gust
