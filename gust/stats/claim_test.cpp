#include "gust/stats/claim.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gust/core/error.h"
#include "gust/core/rng.h"
#include "gust/core/text.h"
#include "gust/stats/sampled_share.h"

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

/// A number whose interval has these ends, for the percentiles of its resamples lie among many equal ones.
Sampled number(double estimate, double low, double high) {
  Sampled number{std::vector<double>(101, low)};
  std::fill(number.values.begin() + 51, number.values.end(), high);
  number.values[0] = estimate;
  number.unit = Unit::episodes;
  number.n = 10;
  return number;
}

Finding judged(std::string_view text, const Sampled& measured, std::optional<std::size_t> seeds = {}) {
  return judge(parse_claim(text, kMetrics, kPlace), measured, seeds);
}

Ruling ruling_of(std::string_view text, double low, double high) {
  return judged(text, number(0.5 * (low + high), low, high)).verdict.ruling;
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
  Sampled censored = number(15.0, 15.0, 15.0);
  censored.upper.assign(censored.values.size(), std::numeric_limits<double>::infinity());
  censored.limit = "the levels end at 15";

  CHECK(judged("margin >= 10", censored).verdict.ruling == Ruling::holds);
  CHECK(judged("margin >= 20", censored).verdict.ruling == Ruling::not_testable);
  CHECK(judged("margin < 10", censored).verdict.ruling == Ruling::fails);
  CHECK(judged("margin < 20", censored).verdict.ruling == Ruling::not_testable);
  CHECK(measured_text(judged("margin >= 10", censored)) == "≥ 15 [≥ 15] (10 episodes)");
  CHECK(measured_text(judged("margin >= 20", censored)) == "≥ 15 [≥ 15] (10 episodes; the levels end at 15)");
}

TEST_CASE("without an interval a claim is not testable") {
  Sampled single = number(0.9, 0.9, 0.9);
  std::fill(single.values.begin() + 1, single.values.end(), std::numeric_limits<double>::quiet_NaN());

  CHECK(judged("anr >= 0.5", single).verdict.ruling == Ruling::not_testable);
  CHECK(judged("anr >= 0.5", single).verdict.reason ==
        "0.9 (no interval); more than one seed or episode would give an interval");
  single.values[0] = single.values[1];
  CHECK(judged("anr >= 0.5", single).verdict.reason == "the estimate is not a number");
}

TEST_CASE("a verdict gives its reason with the numbers, and says what would decide") {
  const Finding found = judged("anr >= 0.95", number(0.96, 0.91234567, 1.0));

  CHECK(ruling_name(found.verdict.ruling) == "undecided");
  CHECK(found.verdict.reason == "0.96 [0.9123, 1] (10 episodes); true in some resamples, false in others");
  CHECK(measured_text(found) == "0.96 [0.9123, 1] (10 episodes; about 230 episodes would decide)");  // 10 x 4.77^2
  CHECK(judged("anr >= 0.95", number(0.95, 0.9, 1.0)).verdict.needed ==
        "no number would decide: the estimate is at the bound");
  CHECK(judged("anr >= 0.95", number(0.951, 0.9, 1.0)).verdict.needed == "more than 10,000 episodes would be needed");
}

/// all of n episodes succeeded in s(0), s(1), …; half of them in s(-1).
class Shares final : public FormulaData {
 public:
  explicit Shares(std::size_t episodes) : episodes_(episodes) {}
  std::vector<std::string> functions() const override { return {"s"}; }
  FormulaValue call(std::string_view, const std::vector<FormulaValue>& arguments) const override {
    const double which = arguments[0].as_number("s").estimate();
    Sampled share{std::vector<double>(2001, which < 0 ? 0.5 : 1.0)};
    share.unit = Unit::episodes;
    share.n = episodes_;
    const Rng rng = Rng(1).split(static_cast<std::uint64_t>(which + 1));
    return {sampled_share(std::move(share), episodes_, Rng(1).split("together"), rng)};
  }

 private:
  std::size_t episodes_;
};

TEST_CASE("at the end of a share the number that would decide is the one of its interval, however the claim is said") {
  const auto said = [](std::size_t episodes, const std::string& text) {
    return judge(Formula(text, kPlace), {}, Shares(episodes)).verdict;
  };
  // Wilson's interval of n successes in n begins at n / (n + z^2), so 99 z^2 = 380.3 episodes decide 0.99.
  const std::string needed = "about 390 episodes would decide";

  for (const std::size_t episodes : {3, 25, 100}) {
    for (const char* text : {"s(0) >= 0.99", "0.99 <= s(0)", "not s(0) < 0.99", "all(s(k) >= 0.99 for k in [0])",
                             "all(s(k) >= 0.99 for k in [0, 1, 2])", "s(0) >= 0.99 and s(1) >= 0.99"}) {
      CAPTURE(text);
      CHECK(said(episodes, text).needed == needed);
    }
    // The least of three shares is lower than each: more episodes, but no more than a few times as many.
    const Verdict least = said(episodes, "min(s(k) for k in [0, 1, 2]) >= 0.99");
    CHECK(least.ruling == Ruling::undecided);
    const auto number = [&](const std::string& from) { return std::stod(from.substr(from.find("about ") + 6)); };
    REQUIRE(least.needed.starts_with("about "));
    CHECK(number(least.needed) >= 390);
    CHECK(number(least.needed) <= 800);
    const Verdict difference = said(episodes, "s(0) - s(1) >= -0.01");
    REQUIRE(difference.needed.starts_with("about "));
    CHECK(number(difference.needed) <= 800);
  }
  CHECK(said(400, "all(s(k) >= 0.99 for k in [0, 1, 2])").ruling == Ruling::holds);
  CHECK(said(1000, "min(s(k) for k in [0, 1, 2]) >= 0.99").ruling == Ruling::holds);
  // Inside the range: 1.96^2 0.6 0.4 / 0.1^2 = 92.2.
  CHECK(said(20, "s(-1) >= 0.6").needed == "about 93 episodes would decide");
  CHECK(said(20, "mean(s(-1), s(-1)) >= 0.6").needed == "about 93 episodes would decide");
}

TEST_CASE("fewer than five seeds decide nothing, and a policy without seeds is decided over episodes") {
  const Sampled clear = number(0.9, 0.85, 0.95);

  CHECK(judged("anr >= 0.5", clear).verdict.ruling == Ruling::holds);
  CHECK(judged("anr >= 0.5", clear, 5).verdict.ruling == Ruling::holds);
  for (const std::size_t seeds : {1u, 2u, 4u}) {
    CHECK(judged("anr >= 0.5", clear, seeds).verdict.ruling == Ruling::undecided);
    CHECK(judged("anr < 0.5", clear, seeds).verdict.ruling == Ruling::undecided);
  }
  CHECK(measured_text(judged("anr >= 0.5", clear, 2)) == "0.9 [0.85, 0.95] (2 seeds; five are needed)");
  CHECK(measured_text(judged("anr >= 0.5", clear, 1)) == "0.9 [0.85, 0.95] (1 seed; five are needed)");
}

/// A number whose resamples are 2000 bootstrap means of n units.
Sampled sampled_mean(double truth, std::size_t n, const Rng& rng) {
  std::vector<double> units(n);
  for (std::size_t u = 0; u < n; ++u) units[u] = truth + rng.normal(u);
  Sampled number{std::vector<double>(2001, 0.0)};
  number.n = n;
  number.unit = Unit::seeds;
  for (const double unit : units) number.values[0] += unit / static_cast<double>(n);
  for (std::size_t k = 1; k < number.values.size(); ++k) {
    const Rng draws = rng.split(k);
    for (std::size_t u = 0; u < n; ++u) number.values[k] += units[draws.below(n, u)] / static_cast<double>(n);
  }
  return number;
}

/// What x_0 >= 0 and x_1 >= 0 and … comes to, of numbers that are sampled anew for every study.
class ManyParts final : public FormulaData {
 public:
  ManyParts(double truth, const Rng& rng) : first(truth), truth_(truth), rng_(rng) {}
  std::vector<std::string> functions() const override { return {"x"}; }
  FormulaValue call(std::string_view, const std::vector<FormulaValue>& arguments) const override {
    const auto which = static_cast<std::uint64_t>(arguments[0].as_number("x").estimate());
    return {sampled_mean(which == 0 ? first : truth_, 10, rng_.split(which))};
  }
  double first;  ///< the truth of part 0

 private:
  double truth_;
  Rng rng_;
};

Finding judged_parts(std::size_t parts, const ManyParts& data) {
  std::vector<std::string> numbers;
  for (std::size_t k = 0; k < parts; ++k) numbers.push_back(cat(k));
  return judge(Formula(cat("all(x(k) >= 0 for k in [", join(numbers, ", "), "])"), kPlace), {}, data);
}

TEST_CASE(
    "a claim of many parts that are all true by little does not fail by chance, and one part that is false fails it") {
  constexpr std::size_t kStudies = 100;
  const double one_error = 1.0 / std::sqrt(10.0);
  for (const std::size_t parts : {1, 20, 50}) {
    double fails = 0, found = 0, whole = 0;  // the last by the rule that decision 15 replaces
    for (std::size_t study = 0; study < kStudies; ++study) {
      ManyParts data(one_error, Rng(study).split(parts));
      const Finding right = judged_parts(parts, data);
      fails += right.verdict.ruling == Ruling::fails ? 1.0 / kStudies : 0.0;
      whole += right.share <= 0.025 ? 1.0 / kStudies : 0.0;
      data.first = -8 * one_error;
      const Finding wrong = judged_parts(parts, data);
      found += wrong.verdict.ruling == Ruling::fails && wrong.parts[0].ruling == Ruling::fails ? 1.0 / kStudies : 0.0;
    }
    MESSAGE(parts, " parts: fails ", fails, ", judged whole ", whole, ", finds ", found);
    CHECK(fails <= whole + 0.02);
    CHECK(fails <= 0.04);
    CHECK(found >= 0.9);
  }
}

TEST_CASE("the parts of a claim say which names they are of, and the one furthest from being true decides") {
  const Finding found =
      judge(Formula("all(1 <= k + l for k in [1, 2] for l in [0, -1]) and 'a' == 'a' and not 3 < 2", kPlace), {},
            ManyParts(0, Rng(1)));

  REQUIRE(found.parts.size() == 6);
  CHECK(found.parts[1].label == "k = 1, l = -1");
  CHECK(found.parts[1].statement == "1 <= k + l");
  CHECK_FALSE(found.parts[1].is_true);
  CHECK(found.parts[5].statement == "not 3 < 2");
  CHECK(found.parts[5].label.empty());
  CHECK(found.true_parts() == 5);
  CHECK(found.margin.estimate == -1.0);
  CHECK(found.measured.estimate == -1.0);
  CHECK(found.verdict.ruling == Ruling::fails);
}

TEST_CASE("parts that are left out are not ruled, and without any left there is nothing to test") {
  const Formula formula("1 > 2 and 2 > 1 and 3 > 1", kPlace);
  const auto without = [&](const std::string& statement) {
    return judge(formula, {}, ManyParts(0, Rng(1)), [&](const TruthPart& part) { return part.statement != statement; });
  };

  CHECK(without("2 > 1").verdict.ruling == Ruling::holds);
  CHECK(without("2 > 1").left_out == 2);
  CHECK(without("1 > 2").verdict.ruling == Ruling::fails);
  CHECK(without("").verdict.ruling == Ruling::not_testable);
  CHECK(without("").parts.empty());
  CHECK(without("").left_out == 3);
}

TEST_CASE(
    "by intervals that are wide enough for few seeds a verdict stands where few enough resamples are against it") {
  const auto widened = [](std::size_t against, std::size_t seeds) {
    Sampled number{std::vector<double>(2001, 1.0)};
    std::fill_n(number.values.begin() + 1, against, -1.0);
    number.n = seeds;
    const Finding found = judged("anr > 0", number, seeds);
    CHECK(found.verdict.ruling == Ruling::holds);
    return found.widened;
  };

  CHECK(widened(16, 10) == Ruling::holds);  // 0.8 %; 0.855 % may be, decision 13
  CHECK(widened(18, 10) == Ruling::undecided);
  CHECK(widened(1, 5) == Ruling::holds);  // 0.05 %; 0.095 %
  CHECK(widened(3, 5) == Ruling::undecided);
}

}  // namespace
}  // namespace gust
