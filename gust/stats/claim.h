#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gust/core/value.h"
#include "gust/stats/formula.h"
#include "gust/stats/interval.h"

namespace gust {

enum class Relation { at_least, above, at_most, below };

/// A statement about one number, such as "survival >= 0.95".
struct Claim {
  std::string metric;
  Relation relation = Relation::at_least;
  double bound = 0.0;
};

std::string_view sign_of(Relation relation);

/// "survival >= 0.95"
std::string claim_text(const Claim& claim);

/// Reads "METRIC RELATION NUMBER", the relation being one of >=, >, <= and <. Throws an Error at the place of the text,
/// with the column within it, if it is anything else or the metric is not one of those given.
Claim parse_claim(std::string_view text, std::span<const std::string> metrics, const Place& place);

enum class Ruling { holds, fails, undecided, not_testable };

/// "holds", "fails", "undecided" or "not testable".
std::string_view ruling_name(Ruling ruling);

/// A verdict as a reader hears it: how much of a claim of many parts was shown.
enum class Grade { shown, open, refuted_in_part, refuted, not_comparable, not_testable };

/// "shown", "open", "refuted in part", "refuted", "not comparable" or "not testable".
std::string_view grade_name(Grade grade);

/// Refuted in part: some of its parts are true at the estimate. Not comparable: the premise of all its parts did not
/// happen here.
Grade grade_of(Ruling ruling, std::size_t parts, std::size_t true_parts, std::size_t left_out_parts);

struct Verdict {
  Ruling ruling = Ruling::not_testable;
  std::string reason;       ///< a sentence with the numbers
  std::string needed = {};  ///< what would decide it: "about 40 episodes would decide", "five are needed"
};

/// A verdict about trained policies needs this many seeds of each; from fewer a claim is undecided. The percentile
/// interval of two seeds is [min, max], which covers half.
inline constexpr std::size_t kSeedsForVerdict = 5;

/// What one of the statements that must all be true came to (TruthPart).
struct PartFinding {
  std::string statement, label;
  Interval margin;  ///< by how much it is true; below 0 if it is not
  Ruling ruling = Ruling::not_testable;
  bool is_true = false;  ///< at the estimate
};

/// What a statement came to.
struct Finding {
  Interval measured;  ///< of what it measures (Formula::Judged), of several parts the margin of the one that decides
  Interval margin;    ///< by how much the part that decides is true; below 0 if it is not
  Verdict verdict;
  double share = std::numeric_limits<double>::quiet_NaN();  ///< of the resamples in which all of it is surely true
  std::vector<PartFinding> parts = {};  ///< statements that must all be true; none where it could not be asked
  std::size_t left_out = 0;             ///< parts that were not to be ruled
  std::size_t seeds = 0;                ///< the fewest of any policy with seeds that was asked; 0 if none was

  /// The ruling by intervals that are wide enough for so few seeds (widened_tail); the verdict's own without seeds.
  Ruling widened = Ruling::not_testable;

  std::size_t true_parts() const;  ///< at the estimate
};

/// A part holds if it is true throughout the interval of its margin, and fails if nowhere; where there are several, it
/// fails only if that stands after Holm's correction for their number, so that one of many parts does not fail by
/// chance (decision 15). The statement holds if all parts do, and fails if one of them fails; else it is undecided, and
/// so it is with fewer than kSeedsForVerdict seeds. Without an interval, where data are missing, or where levels end
/// before the answer, it is not testable. The part that decides is the one furthest from being true, in standard
/// errors.
/// Parts for which `leave_out` is true are not ruled; where none is left the statement is not testable.
Finding judge(const Formula& formula, const FormulaNames& names, const FormulaData& data,
              const std::function<bool(const TruthPart&)>& leave_out = {});

/// The same of a bound for one number, measured with as many seeds; none if it has no seeds.
Finding judge(const Claim& claim, const Sampled& measured, std::optional<std::size_t> seeds);

/// How much more data would decide a statement at the present spread, as a factor: the interval's half-width shrinks
/// with the square root of the data, and has to be less than the distance between the estimate and the bound. At that
/// much the statement is decided in about half of all studies. `margin` is by how much the statement holds, with its
/// interval. Infinite where the estimate is at the bound.
double data_needed(const Interval& margin);

/// "about 40 episodes would decide"; without a unit the number is a factor of the data. More than 10,000 are told as
/// that, and an estimate at the bound as one that no number decides.
std::string needed_text(double number, Unit unit);

/// "0.6854 [0.6749, 0.6959] (10 seeds)", with what would decide it: "… (2 seeds; five are needed)".
std::string measured_text(const Finding& finding);

}  // namespace gust
