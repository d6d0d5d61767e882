#include <algorithm>
#include <cmath>
#include <optional>

#include "gust/core/text.h"
#include "gust/eval/claim.h"
#include "gust/eval/share.h"

namespace gust {
namespace {

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

/// How many times the data of a share of successes would decide whether it is on one side of a bound: Wilson's interval
/// leaves the bound out from z^2 b (1 - b) / (s - b)^2 trials on.
double share_needed(const Sampled& share, double bound) {
  return wilson_trials(share.estimate(), bound) / share.trials;
}

std::string needed_of(double factor, const Sampled& measured) {
  if (measured.unit == Unit::none) return needed_text(std::max(factor, 1.1), Unit::none);
  const auto present = static_cast<double>(measured.n);
  return needed_text(std::max(factor * present, present + 1.0), measured.unit);
}

/// What follows from the margin of a statement, told with the number that was measured.
Verdict ruled(const Formula::Judged& judged, const Interval& interval, const std::string& measured) {
  const Sampled& margin = judged.truth.margin;
  if (std::isnan(interval.estimate)) return {Ruling::not_testable, "the estimate is not a number"};
  if (std::isnan(interval.low) || std::isnan(interval.high)) {
    const char* why =
        all_unknown(margin) ? "more than one seed or episode would give an interval" : "a resample is not a number";
    return {Ruling::not_testable, cat(measured, "; ", why)};
  }
  if (interval.low >= 0) return {Ruling::holds, measured};
  if (interval.high < 0) return {Ruling::fails, measured};
  if (hangs_on_bounds(margin)) return {Ruling::not_testable, cat(measured, "; ", margin.limit), margin.limit};
  const bool is_share = judged.measured.trials > 0 && !std::isnan(judged.bound);
  const double factor = is_share ? share_needed(judged.measured, judged.bound) : data_needed(interval);
  return {Ruling::undecided, cat(measured, "; true in some resamples, false in others"),
          needed_of(factor, judged.measured)};
}

Finding found(const Formula::Judged& judged, std::optional<std::size_t> seeds) {
  Finding finding{.measured = interval_of(judged.measured), .share = share_true(judged.truth.margin)};
  finding.parts = judged.truth.parts;
  finding.true_parts = judged.truth.true_parts;
  Interval& measured = finding.measured;
  for (double* end : {&measured.estimate, &measured.low, &measured.high}) {
    if (std::abs(*end) < std::numeric_limits<double>::min()) *end = 0.0;  // what strict relations between equals give
  }
  Verdict& verdict = finding.verdict;
  verdict = ruled(judged, interval_of(judged.truth.margin), interval_text(measured));
  if (verdict.ruling == Ruling::not_testable) return finding;
  finding.seeds = seeds.value_or(0);
  if (!seeds || *seeds >= kSeedsForVerdict) return finding;
  verdict = {Ruling::undecided,
             cat(interval_text(measured), "; ", *seeds, *seeds == 1 ? " seed" : " seeds", "; five are needed"),
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

std::string needed_text(double number, Unit unit) {
  if (std::isnan(number)) return "more seeds and more episodes would decide";
  if (!std::isfinite(number) || number > 1e3 * kMostNeeded)
    return "no number would decide: the estimate is at the bound";
  const std::string_view what = unit == Unit::none ? "times as much data" : unit_name(unit);
  if (number > kMostNeeded) return cat("more than 10,000 ", what, " would be needed");
  return cat("about ", rounded_up(number), " ", what, " would decide");
}

double data_needed(const Interval& margin) {
  const double width = margin.estimate < 0 ? margin.high - margin.estimate : margin.estimate - margin.low;
  const double distance = std::abs(margin.estimate);
  if (distance < std::numeric_limits<double>::min()) return std::numeric_limits<double>::infinity();
  return (width / distance) * (width / distance);
}

Finding judge(const Formula& formula, const FormulaNames& names, const FormulaData& data) {
  std::optional<Formula::Judged> judged;
  data.fewest_seeds();  // of the question before
  try {
    judged = formula.judge(names, data);
  } catch (const NotTestable& missing) {
    return {{}, {Ruling::not_testable, missing.what()}};
  }
  return found(*judged, data.fewest_seeds());
}

Finding judge(const Claim& claim, const Sampled& measured, std::optional<std::size_t> seeds) {
  const Sampled bound = Sampled::constant(claim.bound);
  return found({measured, related(sign_of(claim.relation), measured, bound), claim.bound}, seeds);
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
