#pragma once

#include <string>
#include <vector>

#include "gust/report/page.h"

namespace gust {

/// "0.46 N [0.44, 0.49]", "≥ 15 N" where the grid ended first; unit as in the sweep. HTML.
std::string margin_html(const Page& page, const Page::Margin& margin);

/// The score of a policy that nothing disturbs, as its margins have it; NaN where it is not known.
double undisturbed(const Page& page, std::size_t policy, std::size_t start);

/// The policy whose margin is clearly the largest of a sweep: its ratio to each other is above 1 on the same episodes,
/// or its interval lies above theirs where they were not compared. Those whose
/// undisturbed score falls short of the best are left out. kNone where two overlap, where two outlast the grid, or
/// where there is nobody to compare with.
std::size_t clear_winner(const Page& page, std::size_t sweep, std::size_t start);

/// What the margins say, one HTML sentence each, the most general first. For the page's first start.
std::vector<std::string> answer_html(const Page& page);

/// What the numbers rest on and where they stop, one HTML sentence each.
std::vector<std::string> confidence_html(const Page& page);

}  // namespace gust
