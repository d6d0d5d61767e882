#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "gust/core/value.h"
#include "gust/eval/formula.h"
#include "gust/eval/interval.h"

namespace gust {

enum class Relation { at_least, above, at_most, below };

/// A statement about one number, such as "survival >= 0.95".
struct Claim {
  std::string metric;
  Relation relation = Relation::at_least;
  double bound = 0.0;
};

/// "survival >= 0.95"
std::string claim_text(const Claim& claim);

/// Reads "METRIC RELATION NUMBER", the relation being one of >=, >, <= and <. Throws an Error at the place of the text,
/// with the column within it, if it is anything else or the metric is not one of those given.
Claim parse_claim(std::string_view text, std::span<const std::string> metrics, const Place& place);

enum class Ruling { holds, fails, undecided, not_testable };

/// "holds", "fails", "undecided" or "not testable".
std::string_view ruling_name(Ruling ruling);

struct Verdict {
  Ruling ruling = Ruling::not_testable;
  std::string reason;  ///< a sentence with the numbers
};

/// What a formula's statement came to.
struct Finding {
  Interval measured;  ///< of what it measures (Formula::Judged)
  Verdict verdict;
  double share = std::numeric_limits<double>::quiet_NaN();  ///< of the resamples in which it is true
  std::size_t parts = 0;       ///< statements that must all be true (Truth); 0 where it could not be asked
  std::size_t true_parts = 0;  ///< those that are, at the estimate
};

/// Holds if the statement is true throughout the interval of its margin, fails if nowhere, else it is undecided.
/// Without an interval, or where data are missing, it is not testable.
Finding judge(const Formula& formula, const FormulaNames& names, const FormulaData& data);

/// Holds if the whole interval satisfies the claim, fails if none of it does, else it is undecided. Without an interval
/// (one value only, or none that is finite) the claim is not testable: a single number says nothing about the next one.
Verdict decide(const Claim& claim, const Interval& interval);

}  // namespace gust
