#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <optional>

#include "gust/core/text.h"
#include "gust/stats/bootstrap.h"
#include "gust/stats/claim.h"
#include "gust/stats/share.h"
#include "gust/stats/statistics.h"

namespace gust {
namespace {

using LeaveOut = std::function<bool(const TruthPart&)>;

constexpr double kTail = 0.025;         // on one side of a 95 % interval
constexpr double kMostNeeded = 10'000;  // units that a person may think of running

/// The resamples of a margin that say something; of a constant the constant itself.
std::span<const double> resamples_of(const std::vector<double>& values) {
  return std::span(values).subspan(values.size() == 1 ? 0 : 1);
}

bool all_unknown(const Sampled& margin) {
  return std::ranges::all_of(resamples_of(margin.values), [](double value) { return std::isnan(value); });
}

/// The share of resamples in which a statement is true; where it has no value it is not. Not a number if it has none in
/// any of them.
double share_true(const Sampled& margin) {
  if (margin.is_constant()) return margin.estimate() >= 0 ? 1.0 : 0.0;
  const std::span<const double> resamples = resamples_of(margin.values);
  if (all_unknown(margin)) return resamples.front();
  const auto count = std::ranges::count_if(resamples, [](double value) { return value >= 0; });
  return static_cast<double>(count) / static_cast<double>(resamples.size());
}

/// A statement is not decided, and would be if what lies beyond the levels were known.
bool hangs_on_bounds(const Sampled& margin) {
  if (margin.upper.empty()) return false;
  if (!margin.bounds(0).exact() && margin.bounds(0).low < 0 && margin.bounds(0).high >= 0) return true;
  Sampled least{margin.values}, most{margin.upper};
  return interval_of(least).high < 0 || interval_of(most).low >= 0;
}

/// Two digits, rounded up.
double rounded_up(double number) {
  const double step = std::pow(10.0, std::max(0.0, std::floor(std::log10(number)) - 1.0));
  return std::ceil(number / step - 1e-9) * step;
}

std::string needed_of(double factor, const Sampled& measured) {
  if (measured.unit == Unit::none) return needed_text(std::max(factor, 1.1), Unit::none);
  const auto present = static_cast<double>(measured.n);
  return needed_text(std::max(factor * present, present + 1.0), measured.unit);
}

/// A part with what its rule needs.
struct Weighed {
  TruthPart part;
  Interval margin;
  double tail = 1.0;      ///< how likely resamples as far on the wrong side are if it is true; 1 unless all of it is
  double distance = 0.0;  ///< from being false, in standard errors
  Ruling ruling = Ruling::undecided;
};

/// How many times the data would decide a part. The end of its interval on the side of the bound comes to the bound: of
/// a share as Wilson's interval does, of what is computed from shares that are all 0 or 1 with 1 / n.
double factor_needed(const Weighed& part) {
  const Interval& margin = part.margin;
  const double end = margin.estimate < 0 ? margin.high : margin.low;
  const double bound = part.part.share_bound;
  if (!std::isnan(bound)) {
    const double share = bound + margin.estimate, reached = bound + end;
    const double present = wilson_trials(share, reached);  // of the interval at hand
    if (present > 0.0 && std::isfinite(present)) return wilson_trials(share, bound) / present;
  }
  const double squared = data_needed(margin);
  return part.part.margin.at_ends ? std::sqrt(squared) : squared;
}

/// The standard error that the resamples show, of a mean of n units: they deviate too little by sqrt((n - 1) / n).
double standard_error(const Sampled& margin) {
  const std::span<const double> resamples = resamples_of(margin.values);
  if (margin.is_constant() || !std::ranges::all_of(resamples, [](double value) { return std::isfinite(value); }))
    return 0.0;
  const auto n = static_cast<double>(margin.n);
  return sample_deviation(resamples) * (margin.n > 1 ? std::sqrt(n / (n - 1.0)) : 1.0);
}

/// Of a part whose interval lies below 0: the share of resamples above it, and where there is none what Student's t
/// says.
double wrong_side_tail(const Sampled& margin, double error, double side) {
  const std::span<const double> ends = resamples_of(margin.upper_ends());
  const auto above = std::ranges::count_if(ends, [](double value) { return value >= 0; });
  const auto count = static_cast<double>(ends.size());
  if (above > 0) return std::min(side, static_cast<double>(above) / count);
  const double least = margin.is_constant() ? 0.0 : std::min(side, 1.0 / (count + 1.0));
  if (error == 0.0 || margin.n < 2) return least;
  const boost::math::students_t student(static_cast<double>(margin.n - 1));
  return std::min(least, boost::math::cdf(boost::math::complement(student, -margin.estimate() / error)));
}

Weighed weighed(TruthPart part, double side) {
  const double error = standard_error(part.margin);
  const Interval margin = interval_of(part.margin, 1.0 - 2.0 * side);
  Weighed result{std::move(part), margin};
  const double estimate = result.margin.estimate;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  result.distance = error > 0.0 ? estimate / error : estimate < 0 ? -kFar : kFar;
  if (std::isnan(estimate) || std::isnan(result.margin.low) || std::isnan(result.margin.high)) {
    result.ruling = Ruling::not_testable;
  } else if (result.margin.low >= 0) {
    result.ruling = Ruling::holds;
  } else if (result.margin.high < 0) {
    result.tail = wrong_side_tail(result.part.margin, error, side);
  } else if (hangs_on_bounds(result.part.margin)) {
    result.ruling = Ruling::not_testable;
  }
  return result;
}

/// Holm: the smallest of m tails is held against side / m, the next one against side / (m - 1), up to the first that is
/// larger.
void refute(std::vector<Weighed>& parts, double side) {
  std::vector<Weighed*> by_tail;
  for (Weighed& part : parts) by_tail.push_back(&part);
  std::ranges::stable_sort(by_tail, {}, &Weighed::tail);
  for (std::size_t i = 0; i < by_tail.size(); ++i) {
    if (by_tail[i]->tail > side / static_cast<double>(by_tail.size() - i)) return;
    by_tail[i]->ruling = Ruling::fails;
  }
}

/// Every part by itself, with `side` outside its interval on each side.
std::vector<Weighed> weighed(const std::vector<TruthPart>& all, double side) {
  std::vector<Weighed> parts;
  for (const TruthPart& part : all) parts.push_back(weighed(part, side));
  refute(parts, side);
  return parts;
}

/// The part on which the statement hangs: of those that rule as it does the one furthest from being true.
const Weighed& deciding(const std::vector<Weighed>& parts) {
  for (const Ruling ruling : {Ruling::fails, Ruling::not_testable, Ruling::undecided}) {
    const Weighed* found = nullptr;
    for (const Weighed& part : parts) {
      const bool further = found == nullptr || part.distance < found->distance ||
                           (part.distance == found->distance && part.margin.estimate < found->margin.estimate);
      if (part.ruling == ruling && further) found = &part;
    }
    if (found != nullptr) return *found;
  }
  return *std::ranges::min_element(parts, [](const Weighed& a, const Weighed& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.margin.estimate < b.margin.estimate;
  });
}

/// What follows from the part that decides, told with the number that was measured.
Verdict ruled(const Weighed& part, const std::string& measured) {
  const Sampled& margin = part.part.margin;
  if (part.ruling == Ruling::holds || part.ruling == Ruling::fails) return {part.ruling, measured};
  if (part.ruling == Ruling::not_testable) {
    if (std::isnan(part.margin.estimate)) return {part.ruling, "the estimate is not a number"};
    if (!std::isnan(part.margin.low) && !std::isnan(part.margin.high))
      return {part.ruling, cat(measured, "; ", margin.limit), margin.limit};
    const std::string_view more = "more than one seed or episode would give an interval";
    const std::string_view why = !all_unknown(margin)   ? "a resample is not a number"
                                 : margin.limit.empty() ? more
                                                        : std::string_view(margin.limit);
    return {part.ruling, cat(measured, "; ", why)};
  }
  const char* why = part.margin.high < 0 ? "; false in all resamples, which one of so many parts may be by chance"
                                         : "; true in some resamples, false in others";
  return {part.ruling, cat(measured, why), needed_of(factor_needed(part), margin)};
}

/// Without what strict relations between equals give.
Interval rounded(Interval interval) {
  for (double* end : {&interval.estimate, &interval.low, &interval.high}) {
    if (std::abs(*end) < std::numeric_limits<double>::min()) *end = 0.0;
  }
  return interval;
}

Finding found(const Formula::Judged& judged, std::optional<std::size_t> seeds, const LeaveOut& leave_out = {}) {
  std::vector<TruthPart> all = judged.truth.all_parts();
  const std::size_t left_out = leave_out ? std::erase_if(all, leave_out) : 0;
  if (all.empty()) return {.verdict = {Ruling::not_testable, "no part of it is to be ruled"}, .left_out = left_out};
  const std::vector<Weighed> parts = weighed(all, kTail);
  const Weighed& decides = deciding(parts);
  Finding finding{.margin = rounded(decides.margin), .share = share_true(judged.truth.margin), .left_out = left_out};
  finding.measured = parts.size() + left_out > 1 ? finding.margin : rounded(interval_of(judged.measured));
  for (const Weighed& part : parts)
    finding.parts.push_back(
        {part.part.statement, part.part.label, rounded(part.margin), part.ruling, part.margin.estimate >= 0});
  Verdict& verdict = finding.verdict;
  verdict = ruled(decides, interval_text(finding.measured));
  if (verdict.ruling == Ruling::not_testable) return finding;
  finding.seeds = seeds.value_or(0);
  finding.widened = verdict.ruling;
  if (finding.seeds >= kSeedsForVerdict) finding.widened = deciding(weighed(all, widened_tail(finding.seeds))).ruling;
  if (!seeds || *seeds >= kSeedsForVerdict) return finding;
  finding.widened = Ruling::undecided;
  for (PartFinding& part : finding.parts) {
    if (part.ruling != Ruling::not_testable) part.ruling = Ruling::undecided;
  }
  verdict = {Ruling::undecided,
             cat(interval_text(finding.measured), "; ", *seeds, *seeds == 1 ? " seed" : " seeds", "; five are needed"),
             "five are needed"};
  return finding;
}

}  // namespace

std::string_view ruling_name(Ruling ruling) {
  switch (ruling) {
    case Ruling::holds:
      return "holds";
    case Ruling::fails:
      return "fails";
    case Ruling::undecided:
      return "undecided";
    case Ruling::not_testable:
      break;
  }
  return "not testable";
}

std::string_view grade_name(Grade grade) {
  switch (grade) {
    case Grade::shown:
      return "shown";
    case Grade::open:
      return "open";
    case Grade::refuted_in_part:
      return "refuted in part";
    case Grade::refuted:
      return "refuted";
    case Grade::not_comparable:
      return "not comparable";
    case Grade::not_testable:
      break;
  }
  return "not testable";
}

Grade grade_of(Ruling ruling, std::size_t parts, std::size_t true_parts, std::size_t left_out_parts) {
  if (parts == 0 && left_out_parts > 0) return Grade::not_comparable;
  switch (ruling) {
    case Ruling::holds:
      return Grade::shown;
    case Ruling::undecided:
      return Grade::open;
    case Ruling::fails:
      return true_parts > 0 ? Grade::refuted_in_part : Grade::refuted;
    case Ruling::not_testable:
      break;
  }
  return Grade::not_testable;
}

std::string needed_text(double number, Unit unit) {
  if (std::isnan(number)) return "more seeds and more episodes would decide";
  if (!std::isfinite(number) || number > 1e3 * kMostNeeded)
    return "no number would decide: the estimate is at the bound";
  const std::string_view what = unit == Unit::none ? "times as much data" : unit_name(unit);
  if (number > kMostNeeded) return cat("more than 10,000 ", what, " would be needed");
  return cat("about ", rounded_up(number), " ", what, " would decide");
}

std::size_t Finding::true_parts() const {
  return static_cast<std::size_t>(std::ranges::count_if(parts, &PartFinding::is_true));
}

double data_needed(const Interval& margin) {
  const double width = margin.estimate < 0 ? margin.high - margin.estimate : margin.estimate - margin.low;
  const double distance = std::abs(margin.estimate);
  if (distance < std::numeric_limits<double>::min()) return std::numeric_limits<double>::infinity();
  return (width / distance) * (width / distance);
}

Finding judge(const Formula& formula, const FormulaNames& names, const FormulaData& data, const LeaveOut& leave_out) {
  std::optional<Formula::Judged> judged;
  data.fewest_seeds();  // of the question before
  try {
    judged = formula.judge(names, data);
  } catch (const NotTestable& missing) {
    return {.verdict = {Ruling::not_testable, missing.what()}};
  }
  return found(*judged, data.fewest_seeds(), leave_out);
}

Finding judge(const Claim& claim, const Sampled& measured, std::optional<std::size_t> seeds) {
  const Sampled bound = Sampled::constant(claim.bound);
  return found({measured, related(sign_of(claim.relation), measured, bound)}, seeds);
}

std::string measured_text(const Finding& finding) {
  const Interval& measured = finding.measured;
  const std::string& needed = finding.verdict.needed;
  if (!std::isfinite(measured.estimate) && std::isnan(measured.most)) return finding.verdict.reason;
  if (needed.empty()) return interval_text(measured);
  Interval bare = measured;
  bare.unit = Unit::none;
  std::string units;
  if (finding.verdict.ruling == Ruling::undecided && finding.seeds > 0 && finding.seeds < kSeedsForVerdict)
    units = cat(finding.seeds, finding.seeds == 1 ? " seed; " : " seeds; ");
  else if (measured.unit != Unit::none)
    units = cat(measured.n, " ", unit_name(measured.unit), "; ");
  return cat(interval_text(bare), " (", units, needed, ")");
}

}  // namespace gust
