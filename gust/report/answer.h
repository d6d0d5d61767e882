#pragma once

#include <string>
#include <vector>

#include "gust/report/page.h"

namespace gust {

/// The text of a margin in two parts: "0.46", "≥ 15" or whatever stands for it, and the interval or nothing.
struct MarginWords {
  std::string value;
  std::string interval;
};
MarginWords margin_words(const Page::Margin& margin);

/// "0.46 N [0.44, 0.49]": the text of a margin with the unit of its sweep behind a number. HTML.
std::string margin_html(const Page& page, const Page::Margin& margin);

/// The score of a policy that nothing disturbs, as its margins have it; NaN where it is not known.
double undisturbed(const Page& page, std::size_t policy, std::size_t start);

/// The policy whose margin is clearly the largest of a sweep: its ratio to each other is above 1 on the same episodes,
/// or its interval lies above theirs where they were not compared. Those whose
/// undisturbed score falls short of the best are left out. kNone where two overlap, where two outlast the grid, or
/// where there is nobody to compare with.
std::size_t clear_winner(const Page& page, std::size_t sweep, std::size_t start);

/// What the margins from a start say, one HTML sentence each, the most general first.
std::vector<std::string> answer_html(const Page& page, std::size_t start);

/// What the numbers rest on and where they stop, one HTML sentence each.
std::vector<std::string> confidence_html(const Page& page);

}  // namespace gust
