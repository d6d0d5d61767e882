#include "gust/eval/claim.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gust/core/error.h"

namespace gust {
namespace {

const std::vector<std::string> kMetrics = {"survival", "anr", "anr_h", "margin"};
const Place kPlace{"study.toml", 40, 9};

std::string error_of(std::string_view text) {
  try {
    parse_claim(text, kMetrics, kPlace);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

Ruling ruling_of(std::string_view text, double low, double high) {
  const Interval found{.estimate = 0.5 * (low + high), .low = low, .high = high, .unit = Unit::seeds, .n = 10};
  return decide(parse_claim(text, kMetrics, kPlace), found).ruling;
}

TEST_CASE("a claim is a metric, a relation and a number") {
  const Claim claim = parse_claim("survival >= 0.95", kMetrics, kPlace);
  const Claim tight = parse_claim("  anr_h<-1.5e-3 ", kMetrics, kPlace);

  CHECK(claim.metric == "survival");
  CHECK(claim.relation == Relation::at_least);
  CHECK(claim.bound == 0.95);
  CHECK(tight.metric == "anr_h");
  CHECK(tight.relation == Relation::below);
  CHECK(tight.bound == -1.5e-3);
  CHECK(parse_claim("anr > 1", kMetrics, kPlace).relation == Relation::above);
  CHECK(parse_claim("anr <= 1", kMetrics, kPlace).relation == Relation::at_most);
}

TEST_CASE("the text of a claim reads back as the same claim") {
  for (const std::string text : {"survival >= 0.95", "anr > 1", "anr_h <= -3e-07", "margin < 12.5"}) {
    CHECK(claim_text(parse_claim(text, kMetrics, kPlace)) == text);
  }
}

TEST_CASE("a misspelt claim is an error with place, column and what would be right") {
  CHECK(error_of("survivel >= 0.95") ==
        "study.toml:40:9: claim 'survivel >= 0.95', column 1: unknown metric 'survivel'; did you mean 'survival'?");
  CHECK(error_of("survival => 0.95") ==
        "study.toml:40:9: claim 'survival => 0.95', column 10: expected >=, >, <= or <");
  CHECK(error_of("survival >= ") == "study.toml:40:9: claim 'survival >= ', column 13: expected a finite number");
  CHECK(error_of("survival >= 0.95 or so") ==
        "study.toml:40:9: claim 'survival >= 0.95 or so', column 18: expected nothing after the number");
  CHECK(error_of("  ") == "study.toml:40:9: claim '  ', column 3: expected a metric, such as 'survival >= 0.95'");
}

TEST_CASE("hostile claims are errors") {
  for (const std::string_view text :
       {"", ">= 1", "anr", "anr >=", "anr = 1", "anr >= nan", "anr >= inf", "anr >= 1e999", "anr >= 0x10",
        "anr >= 1 anr >= 1", "anr > = 1", "1 <= anr", "ANR >= 1"}) {
    CAPTURE(text);
    CHECK(error_of(text) != "no error");
  }
  CHECK(error_of(std::string(100'000, 'x')) != "no error");
  CHECK(error_of(std::string_view("anr\0 >= 1", 9)) != "no error");
}

TEST_CASE("a claim holds if the whole interval satisfies it and fails if none of it does") {
  CHECK(ruling_of("anr >= 0.5", 0.5, 0.9) == Ruling::holds);
  CHECK(ruling_of("anr > 0.5", 0.5, 0.9) == Ruling::undecided);
  CHECK(ruling_of("anr > 0.5", 0.1, 0.5) == Ruling::fails);
  CHECK(ruling_of("anr >= 0.5", 0.1, 0.5) == Ruling::undecided);
  CHECK(ruling_of("anr <= 0.5", 0.1, 0.5) == Ruling::holds);
  CHECK(ruling_of("anr < 0.5", 0.5, 0.9) == Ruling::fails);
  CHECK(ruling_of("anr < 0.5", 0.1, 0.9) == Ruling::undecided);
}

TEST_CASE("a censored margin decides only what it can") {
  const double infinity = std::numeric_limits<double>::infinity();  // at least 15 is all that is known

  CHECK(ruling_of("margin >= 10", 15.0, infinity) == Ruling::not_testable);  // an infinite estimate is no number
  const Interval censored{.estimate = 15.0, .low = 15.0, .high = infinity, .unit = Unit::seeds, .n = 10};
  CHECK(decide(parse_claim("margin >= 10", kMetrics, kPlace), censored).ruling == Ruling::holds);
  CHECK(decide(parse_claim("margin >= 20", kMetrics, kPlace), censored).ruling == Ruling::undecided);
  CHECK(decide(parse_claim("margin < 10", kMetrics, kPlace), censored).ruling == Ruling::fails);
  CHECK(decide(parse_claim("margin < 20", kMetrics, kPlace), censored).ruling == Ruling::undecided);
}

TEST_CASE("without an interval a claim is not testable") {
  const Claim claim = parse_claim("anr >= 0.5", kMetrics, kPlace);
  const Interval single{.estimate = 0.9, .unit = Unit::none, .n = 1};

  CHECK(decide(claim, single).ruling == Ruling::not_testable);
  CHECK(decide(claim, single).reason ==
        "anr = 0.9 (no interval); more than one seed or episode would give an interval");
  CHECK(decide(claim, Interval{}).ruling == Ruling::not_testable);
  CHECK(decide(claim, Interval{}).reason == "anr has no finite value");
}

TEST_CASE("a verdict gives its reason with the numbers") {
  const Claim claim = parse_claim("survival >= 0.95", kMetrics, kPlace);
  const Interval found{.estimate = 0.96, .low = 0.91234567, .high = 1.0, .unit = Unit::seeds, .n = 10};

  const Verdict verdict = decide(claim, found);

  CHECK(ruling_name(verdict.ruling) == "undecided");
  CHECK(verdict.reason == "survival = 0.96 [0.9123, 1] (10 seeds); the interval holds values on both sides of 0.95");
}

}  // namespace
}  // namespace gust
