#include "gust/eval/claim.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "gust/core/error.h"
#include "gust/core/text.h"

namespace gust {
namespace {

struct Sign {
  std::string_view text;
  Relation relation;
};

/// The longer one first where one begins with the other.
constexpr std::array<Sign, 4> kSigns = {{
    {">=", Relation::at_least},
    {">", Relation::above},
    {"<=", Relation::at_most},
    {"<", Relation::below},
}};

std::string_view sign_of(Relation relation) {
  for (const Sign& sign : kSigns) {
    if (sign.relation == relation) return sign.text;
  }
  throw Bug("a relation without a sign");
}

/// A claim's text and how far it has been read.
struct Reader {
  std::string_view text;
  const Place& place;
  std::size_t at = 0;

  std::string_view rest() const { return text.substr(at); }

  void skip_blanks() {
    while (at < text.size() && (text[at] == ' ' || text[at] == '\t')) ++at;
  }

  template <class... Parts>
  Error error(std::size_t where, const Parts&... parts) const {
    return error_at(place, "claim '", text, "', column ", where + 1, ": ", parts...);
  }
};

std::string read_metric(Reader& reader, std::span<const std::string> metrics) {
  const std::size_t begin = reader.at;
  const std::size_t length = std::min(reader.rest().find_first_of(" \t<>="), reader.rest().size());
  const std::string name(reader.rest().substr(0, length));
  if (name.empty()) throw reader.error(begin, "expected a metric, such as 'survival >= 0.95'");
  for (const std::string& metric : metrics) {
    if (metric != name) continue;
    reader.at += length;
    return name;
  }
  throw reader.error(begin, "unknown metric '", name, "'", did_you_mean(name, metrics));
}

Relation read_relation(Reader& reader) {
  for (const Sign& sign : kSigns) {
    if (!reader.rest().starts_with(sign.text)) continue;
    reader.at += sign.text.size();
    return sign.relation;
  }
  throw reader.error(reader.at, "expected >=, >, <= or <");
}

double read_bound(Reader& reader) {
  double bound = 0.0;
  const std::string_view rest = reader.rest();
  const auto [end, problem] = std::from_chars(rest.data(), rest.data() + rest.size(), bound);
  if (problem != std::errc() || !std::isfinite(bound)) throw reader.error(reader.at, "expected a finite number");
  reader.at += static_cast<std::size_t>(end - rest.data());
  return bound;
}

bool satisfies(double value, Relation relation, double bound) {
  switch (relation) {
    case Relation::at_least:
      return value >= bound;
    case Relation::above:
      return value > bound;
    case Relation::at_most:
      return value <= bound;
    case Relation::below:
      break;
  }
  return value < bound;
}

/// The share of resamples in which a statement is true; where it has no value it is not. Not a number if it has none in
/// any of them.
double share_true(const Sampled& margin) {
  if (margin.is_constant()) return margin.estimate() >= 0 ? 1.0 : 0.0;
  const std::span<const double> resamples = std::span(margin.values).subspan(1);
  if (std::ranges::all_of(resamples, [](double value) { return std::isnan(value); })) return resamples.front();
  const auto count = std::ranges::count_if(resamples, [](double value) { return value >= 0; });
  return static_cast<double>(count) / static_cast<double>(resamples.size());
}

/// What follows from the margin of a statement, told with the number that was measured.
Verdict ruled(const Sampled& margin, const Interval& interval, const std::string& measured) {
  if (std::isnan(interval.estimate)) return {Ruling::not_testable, "the estimate is not a number"};
  if (std::isnan(interval.low) || std::isnan(interval.high)) {
    const std::span<const double> resamples = std::span(margin.values).subspan(1);
    const bool alone = std::ranges::all_of(resamples, [](double value) { return std::isnan(value); });
    const char* why = alone ? "more than one seed or episode would give an interval" : "a resample is not a number";
    return {Ruling::not_testable, cat(measured, "; ", why)};
  }
  if (interval.low >= 0) return {Ruling::holds, measured};
  if (interval.high < 0) return {Ruling::fails, measured};
  return {Ruling::undecided, cat(measured, "; true in some resamples of the seeds, false in others")};
}

}  // namespace

std::string claim_text(const Claim& claim) { return cat(claim.metric, " ", sign_of(claim.relation), " ", claim.bound); }

Claim parse_claim(std::string_view text, std::span<const std::string> metrics, const Place& place) {
  Reader reader{text, place};
  Claim claim;
  reader.skip_blanks();
  claim.metric = read_metric(reader, metrics);
  reader.skip_blanks();
  claim.relation = read_relation(reader);
  reader.skip_blanks();
  claim.bound = read_bound(reader);
  reader.skip_blanks();
  if (!reader.rest().empty()) throw reader.error(reader.at, "expected nothing after the number");
  return claim;
}

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

Finding judge(const Formula& formula, const FormulaNames& names, const FormulaData& data) {
  std::optional<Formula::Judged> asked;
  try {
    asked = formula.judge(names, data);
  } catch (const NotTestable& missing) {
    return {{}, {Ruling::not_testable, missing.what()}};
  }
  const auto& judged = *asked;
  Finding found{.measured = interval_of(judged.measured), .share = share_true(judged.truth.margin)};
  found.parts = judged.truth.parts;
  found.true_parts = judged.truth.true_parts;
  Interval& measured = found.measured;
  for (double* end : {&measured.estimate, &measured.low, &measured.high}) {
    if (std::abs(*end) < std::numeric_limits<double>::min()) *end = 0.0;  // what strict relations between equals give
  }
  found.verdict = ruled(judged.truth.margin, interval_of(judged.truth.margin), interval_text(measured));
  return found;
}

Verdict decide(const Claim& claim, const Interval& interval) {
  const std::string found = cat(claim.metric, " = ", interval_text(interval));
  if (!std::isfinite(interval.estimate)) return {Ruling::not_testable, cat(claim.metric, " has no finite value")};
  if (std::isnan(interval.low) || std::isnan(interval.high)) {
    return {Ruling::not_testable, cat(found, "; more than one seed or episode would give an interval")};
  }
  const bool low = satisfies(interval.low, claim.relation, claim.bound);
  const bool high = satisfies(interval.high, claim.relation, claim.bound);
  if (low && high) return {Ruling::holds, found};
  if (!low && !high) return {Ruling::fails, found};
  return {Ruling::undecided, cat(found, "; the interval holds values on both sides of ", claim.bound)};
}

}  // namespace gust
