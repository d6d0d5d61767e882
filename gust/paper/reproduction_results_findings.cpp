#include <algorithm>
#include <cmath>
#include <iterator>

#include "gust/core/text.h"
#include "gust/paper/measured_findings.h"
#include "gust/paper/reproduction_results.h"
#include "gust/paper/verdicts.h"
#include "gust/report/html.h"

namespace gust {
namespace {

std::string hardness_sentence(const PaperResults& results) {
  std::size_t hard = 0, hold = 0;
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty() || results.reproduction.paper->claims[c].soft) continue;
    ++hard;
    hold += on.front()->verdict.ruling == Ruling::holds ? 1 : 0;
  }
  return hard == 0 ? ""
                   : cat("Of the ", hard, " that the paper does not word softly, ", hold, hold == 1 ? " is" : " are",
                         " shown.");
}

/// Claims that are shown under one reading of the paper and refuted under another; the printed tables are no reading of
/// ours.
std::string reading_sentence(const PaperResults& results) {
  std::size_t changing = 0;
  const Paper& paper = *results.reproduction.paper;
  for (std::size_t c = 0; c < paper.claims.size(); ++c) {
    bool holds = false, fails = false;
    for (const PaperVerdict* verdict : results.on(c)) {
      if (paper.readings[verdict->reading].printed) continue;
      holds = holds || verdict->verdict.ruling == Ruling::holds;
      fails = fails || verdict->verdict.ruling == Ruling::fails;
    }
    changing += holds && fails ? 1 : 0;
  }
  if (results.verdicts.empty()) return "";
  if (changing == 0) return "No claim is shown under one reading of the paper and refuted under another.";
  return cat(changing, changing == 1 ? " claim is" : " claims are",
             " shown under one reading of the paper and refuted under another.");
}

/// Percentile intervals of few seeds cover less than they say: whose verdict that may have decided.
std::string narrow_intervals_sentence(const PaperResults& results) {
  std::size_t decided = 0, falling = 0;
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty() || !on.front()->decided() || results.reproduction.paper->claims[c].formula->calls("alike")) continue;
    ++decided;
    falling += on.front()->widened != on.front()->verdict.ruling ? 1 : 0;
  }
  if (decided == 0) return "";
  return cat("Bootstrap intervals of few seeds are too narrow. Widened for that (decision 13), ", decided - falling,
             " of the ", decided, " verdicts that show or refute stand; claims that compare intervals are left out.");
}

/// How often one training of each policy would have shown what all of them refute.
std::string refuted_draws_sentence(const PaperResults& results) {
  std::size_t refuted = 0;
  double shares = 0;
  for (std::size_t c = 0; c < results.reproduction.paper->claims.size(); ++c) {
    const std::vector<const PaperVerdict*> on = results.on(c);
    if (on.empty() || !std::isfinite(on.front()->one_training) || on.front()->verdict.ruling != Ruling::fails) continue;
    ++refuted;
    shares += on.front()->one_training;
  }
  if (refuted == 0) return "";
  return cat("With one training of each policy, claims that all trainings refute would have come out true in ",
             percent(shares / static_cast<double>(refuted)), " of draws on average.");
}

}  // namespace

Findings findings(const PaperResults& results) {
  Findings found{opening_findings(results),
                 {hardness_sentence(results), reading_sentence(results), refuted_draws_sentence(results),
                  narrow_intervals_sentence(results)}};
  std::ranges::move(measured_findings(results), std::back_inserter(found.further));
  std::erase(found.further, "");
  return found;
}

}  // namespace gust
