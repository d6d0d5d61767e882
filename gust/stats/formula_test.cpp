#include "gust/stats/formula.h"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "gust/stats/claim.h"
#include "gust/stats/formula_functions.h"

using namespace gust;

namespace {

/// Two policies along three levels, each score with two resamples: r(policy) is a curve, r(policy, level) a number.
class TwoPolicies final : public FormulaData {
 public:
  std::vector<std::string> functions() const override { return {"r", "gone"}; }
  FormulaValue call(std::string_view function, const std::vector<FormulaValue>& arguments) const override {
    if (function == "gone") throw NotTestable("not measured: gone");
    const std::string& policy = arguments.at(0).as_text("'r'");
    if (policy != "ppo" && policy != "lqr") throw Error(cat("unknown policy '", policy, "'"));
    const double best = policy == "lqr" ? 1.0 : 0.8;
    FormulaList curve{{}, {0.0, 1.0, 3.0}};
    for (const double level : curve.axis) {
      const double score = best * (1.0 - level / 4.0);
      curve.items.push_back({Sampled{{score, score - 0.125, score + 0.125}}});
    }
    return {curve};
  }
};

const FormulaNames kNames = {{"agents", {FormulaList{{{std::string("ppo")}, {std::string("lqr")}}, {}}}}};

FormulaValue evaluated(std::string_view text) { return Formula(text, {"study", 3, 9}).evaluate(kNames, TwoPolicies()); }
double number(std::string_view text) { return evaluated(text).as_number("a test").estimate(); }
bool truth(std::string_view text) { return evaluated(text).as_truth("a test").margin.estimate() >= 0; }
Finding judged(std::string_view text) { return judge(Formula(text, {"study"}), kNames, TwoPolicies()); }
std::string problem(std::string_view text) {
  try {
    evaluated(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("arithmetic has the usual precedence") {
  CHECK(number("1 + 2 * 3 - 8 / 4 / 2") == 6.0);
  CHECK(number("-(1 - 2) * 3") == 3.0);
  CHECK(number("--2 - -1") == 3.0);
}

TEST_CASE("relations, and, or, not are what they are elsewhere") {
  CHECK(truth("1 < 2 and 2 <= 2 and not 3 <= 2"));
  CHECK(truth("1 > 2 or 2 != 3"));
  CHECK_FALSE(truth("2 > 2"));
  CHECK_FALSE(truth("not 2 >= 2"));
  CHECK(truth("not 2 > 2"));
  CHECK(truth("'a' == 'a' and 'a' != 'b'"));
  CHECK_FALSE(truth("1e308 * 10 > 1e308 * 10"));  // of infinities none is above another
  CHECK(truth("1e308 * 10 >= 1e308 * 10"));
}

TEST_CASE("lists are made of lists, the last variable fastest, and a filter leaves items out") {
  CHECK(number("sum([10 * a + b for a in [1, 2] for b in [3, 4] if a != b])") == 13 + 14 + 23 + 24);
  CHECK(number("sum(b for a in [1, 2] for b in [a, 5] if b > a)") == 10);
  CHECK(number("count(a == 'lqr' for a in agents)") == 1.0);
  CHECK(number("max(at(r(a), 0) for a in agents)") == 1.0);
}

TEST_CASE("texts are filled in with names and numbers") {
  CHECK(truth("all('{a} at {k}' == 'ppo at 0.5' for a in ['ppo'] for k in [0.5])"));
  CHECK(truth("'no {brace' == 'no {brace'"));
  CHECK(problem("'{nobody}' == 'x'").ends_with("column 1: unknown name 'nobody'"));
}

TEST_CASE("functions of curves") {
  CHECK(number("area(r('lqr'))") == doctest::Approx((0.875 + 2 * 0.5) / 3).epsilon(1e-15));
  CHECK(number("at(r('lqr'), 2)") == 0.5);
  CHECK(number("half(r('lqr'))") == 3.0);
  CHECK(number("margin(r('lqr'))") == doctest::Approx(0.4).epsilon(1e-12));
  CHECK(number("drop(r('lqr'))") == 0.5);
  CHECK(number("rise([(k - 2) * (k - 2) for k in [0, 1, 2, 3]])") == doctest::Approx(1.0 / 3.0).epsilon(1e-15));
  CHECK(number("rise([7 for k in [1]])") == 0.0);
  CHECK(number("reach([k * k for k in [1, 2, 3]], 4)") == 2.0);
  CHECK(number("reach(r('lqr'), 2)") == std::nextafter(3.0, 4.0));
  CHECK(std::isinf(evaluated("reach(r('lqr'), 2)").as_number("a test").bounds(0).high));
  CHECK(number("argmax([-(k - 2) * (k - 2) for k in [1, 2, 3]])") == 2.0);
  CHECK(number("straightness(r('ppo'))") == doctest::Approx(1.0).epsilon(1e-12));
  CHECK(number("spearman(r('ppo'))") == -1.0);
  CHECK(number("kendall([1, 2, 3], [1, 3, 2])") == doctest::Approx(1.0 / 3.0).epsilon(1e-12));
  CHECK(number("last(r('lqr'))") == 0.25);
  CHECK(number("first(r('lqr')) - last([3, 4])") == -3.0);
  CHECK(number("sum(levels(r('ppo')))") == 4.0);
  CHECK(number("share(at(r('ppo'), k) > 0.5 for k in levels(r('ppo')))") == doctest::Approx(2.0 / 3.0));
}

TEST_CASE("numbers are alike where their intervals overlap or they are near") {
  CHECK(truth("alike(at(r('lqr'), 0), at(r('ppo'), 0), 0)"));
  CHECK_FALSE(truth("alike(at(r('lqr'), 0), at(r('ppo'), 3), 0.5)"));
  CHECK(truth("alike(at(r('lqr'), 0), at(r('ppo'), 3), 0.875)"));
  CHECK_FALSE(truth("alike(1, 2, 0.5)"));
}

TEST_CASE("what holds because intervals overlap leaves the measure to the other parts") {
  const Finding found = judged("alike(at(r('lqr'), 0), at(r('ppo'), 0), 0) and at(r('lqr'), 0) > at(r('ppo'), 3)");
  CHECK(found.verdict.ruling == Ruling::holds);
  CHECK(found.measured.estimate == 1.0 - 0.8 / 4.0);
  CHECK(judged("not alike(at(r('lqr'), 0), at(r('ppo'), 0), 0)").verdict.ruling == Ruling::fails);
}

TEST_CASE("a claim counts the statements that and and all put together, and those that are true") {
  const auto parts = [](std::string_view text) {
    const Finding found = judged(text);
    return std::pair(found.true_parts(), found.parts.size());
  };
  CHECK(parts("1 < 2") == std::pair<std::size_t, std::size_t>(1, 1));
  CHECK(parts("1 < 2 and 3 < 2 and not 2 < 1") == std::pair<std::size_t, std::size_t>(2, 3));
  CHECK(parts("all(k < 3 and k > 1 for k in [1, 2, 3])") == std::pair<std::size_t, std::size_t>(4, 6));
  CHECK(parts("any(k < 3 for k in [1, 2, 3]) or 1 < 2") == std::pair<std::size_t, std::size_t>(1, 1));
  CHECK(parts("all(any(k < l for k in [1, 2]) for l in [1, 2])") == std::pair<std::size_t, std::size_t>(1, 2));
  CHECK(parts("gone('ppo') > 1") == std::pair<std::size_t, std::size_t>(0, 0));
}

TEST_CASE("nothing that is computed from NaN decides a claim") {
  for (const char* unknown :
       {"count(0 / 0 > x for x in [1, 2]) <= 0", "share([0 / 0 > 1]) < 0.5", "argmax([1 / x for x in [0, 1]]) >= 0",
        "drop([1 / x for x in [0, 1]]) < 1", "rise([1 / x for x in [0, 1]]) < 1",
        "reach([1 / x for x in [0, 1]], 9) > 1", "half([1 / x for x in [0, 1]]) > 0",
        "spearman([1 / 0, 1], [1, 2]) > 0", "at(r('lqr'), 0 / 0) > 0.2", "at(r('lqr'), 1 / 0) > 0.2",
        "max(x for x in [1, 2] if 1 / 0 > x) > 0", "half(r('lqr')) == 1 / 0"})
    CHECK_MESSAGE(judged(unknown).verdict.ruling == Ruling::not_testable, unknown);
}

TEST_CASE("a claim holds where all resamples do, fails where none does, else it is undecided") {
  CHECK(judged("at(r('lqr'), 0) > 0.5").verdict.ruling == Ruling::holds);
  CHECK(judged("at(r('lqr'), 0) > 1.5").verdict.ruling == Ruling::fails);
  CHECK(judged("at(r('lqr'), 0) > 1").verdict.ruling == Ruling::undecided);
  CHECK(judged("at(r('lqr'), 0) > 0.5").share == 1.0);
  CHECK(judged("at(r('lqr'), 0) > 1").share == 0.5);
  CHECK(judged("at(r('lqr'), 0) > 1.5").share == 0.0);
  for (const char* unknown : {"1 / 0 > 1", "1 > -1 / 0", "0 / 0 < 1", "2 > 1 or 1 / 0 > 1"})
    CHECK(judged(unknown).verdict.ruling == Ruling::not_testable);
  CHECK(judged("gone('lqr') > 1").verdict.ruling == Ruling::not_testable);
  CHECK(judged("gone('lqr') > 1").verdict.reason == "not measured: gone");
  CHECK(judged("at(r('lqr'), 4) > 1").verdict.ruling == Ruling::not_testable);
}

namespace {

/// margin(flat) is at least 3; margin(steep) lies between 0 and 1; half(steep) is 1.
std::string along(std::string_view text) {
  std::string filled(text);
  const std::pair<std::string, std::string> names[] = {{"flat", "[1 + 0 * k for k in [0, 1, 3]]"},
                                                       {"long", "[1 + 0 * k for k in [0, 1, 7]]"},
                                                       {"steep", "[1 - k for k in [0, 1, 3]]"}};
  for (const auto& [name, curve] : names) {
    for (std::size_t at = filled.find(name); at != std::string::npos; at = filled.find(name))
      filled.replace(at, name.size(), curve);
  }
  return filled;
}

}  // namespace

TEST_CASE("a margin beyond the levels is a bound: it decides what it can, and else the claim is not testable") {
  const std::pair<const char*, Ruling> cases[] = {
      {"margin(flat) >= 2", Ruling::holds},
      {"margin(flat) >= 3", Ruling::holds},
      {"margin(flat) >= 5", Ruling::not_testable},
      {"margin(flat) < 3", Ruling::fails},
      {"margin(flat) < 5", Ruling::not_testable},
      {"half(flat) > 3", Ruling::holds},  // not at the last level either
      {"margin(flat) == margin(flat)", Ruling::not_testable},
      {"margin(flat) != margin(long)", Ruling::not_testable},
      {"margin(flat) < margin(long)", Ruling::not_testable},
      {"margin(flat) > margin(steep)", Ruling::holds},
      {"margin(steep) >= margin(long)", Ruling::fails},
      {"margin(flat) == margin(steep)", Ruling::fails},
      {"margin(flat) - margin(steep) > 2", Ruling::holds},
      {"margin(flat) - margin(steep) > 3", Ruling::not_testable},
      {"margin(steep) - margin(flat) < -2", Ruling::holds},
      {"margin(flat) / margin(steep) > 29", Ruling::holds},
      {"margin(steep) / margin(flat) < 0.034", Ruling::holds},
      {"margin(steep) / margin(flat) < 0.03", Ruling::not_testable},
      {"2 * margin(flat) >= 6", Ruling::holds},
      {"0 * margin(flat) == 0", Ruling::holds},
      {"1 / (margin(flat) - 4) > 0", Ruling::not_testable},
      {"abs(margin(steep) - margin(flat)) > 2", Ruling::holds},
      {"abs(margin(flat) - 5) >= 0", Ruling::holds},
      {"min(margin(flat), 2) == 2", Ruling::holds},
      {"min(margin(flat), margin(steep)) < 1", Ruling::holds},
      {"max(margin(flat), margin(steep)) >= 3", Ruling::holds},
      {"max(margin(flat), margin(steep)) < 9", Ruling::not_testable},
      {"max(margin(flat), 9) >= 9", Ruling::holds},
      {"mean(margin(flat), margin(steep)) > 1.5", Ruling::holds},
      {"mean(margin(flat), margin(steep)) < 9", Ruling::not_testable},
      {"count(m >= 2 for m in [margin(flat), margin(steep)]) == 1", Ruling::holds},
      {"count(m >= 5 for m in [margin(flat), margin(steep)]) == 1", Ruling::not_testable},
      {"count(m >= 5 for m in [margin(flat), margin(steep)]) <= 1", Ruling::holds},
      {"not margin(flat) < 3", Ruling::holds},
      {"not margin(flat) < 5", Ruling::not_testable},
      {"margin(flat) >= 2 and margin(flat) >= 5", Ruling::not_testable},
      {"margin(flat) >= 5 and margin(steep) > 1", Ruling::fails},
      {"margin(flat) >= 5 or margin(steep) < 1", Ruling::holds},
      {"any(margin(flat) >= x for x in [2, 5])", Ruling::holds},
      {"all(margin(flat) >= x for x in [2, 5])", Ruling::not_testable},
      {"spearman([margin(steep), 1, margin(flat)], [1, 2, 3]) == 1", Ruling::holds},
      {"spearman([margin(long), 1, margin(flat)], [1, 2, 3]) > 0", Ruling::not_testable},
      {"kendall([margin(steep), 5, margin(flat)], [1, 2, 3]) >= -1", Ruling::holds},
      {"argmax([min(k + 0 * margin(flat), k) for k in [1, 2]]) == 2", Ruling::holds},
      {"drop([k * margin(flat) for k in [1, 2]]) < 1", Ruling::not_testable},
      {"alike(margin(flat), margin(long), 1)", Ruling::not_testable},
      {"alike(margin(flat), margin(steep), 1)", Ruling::fails},
      {"sum(1 for x in [1] if margin(flat) > 2) == 1", Ruling::holds},
      {"sum(1 for x in [1, 2] if margin(flat) > 5) == 1", Ruling::not_testable},
      {"reach(flat, 2) > 3", Ruling::holds},
      {"reach(flat, 2) < 9", Ruling::not_testable},
  };
  for (const auto& [text, ruling] : cases) {
    CAPTURE(text);
    CHECK(ruling_name(judged(along(text)).verdict.ruling) == ruling_name(ruling));
  }
}

TEST_CASE("a claim that a bound leaves open says where the levels end") {
  CHECK(judged(along("margin(flat) >= 5")).verdict.reason == "≥ 3 [≥ 3]; the levels end at 3");
  CHECK(measured_text(judged(along("margin(flat) >= 2"))) == "≥ 3 [≥ 3]");
  CHECK(judged(along("margin(flat) - margin(long) > 0")).verdict.ruling == Ruling::not_testable);
}

TEST_CASE("a bound in some resamples only leaves a claim undecided or not testable, whichever the others say") {
  const auto with_bounds = [](std::size_t censored) {
    Sampled margin{std::vector<double>(101, 2.5)};
    for (std::size_t i = 0; i < censored; ++i) margin.set(100 - i, {3.0, std::numeric_limits<double>::infinity()});
    margin.limit = "the levels end at 3";
    return margin;
  };
  const auto ruling = [&](Relation relation, double bound, std::size_t censored) {
    return judge(Claim{"margin", relation, bound}, with_bounds(censored), std::nullopt).verdict.ruling;
  };

  CHECK(ruling(Relation::at_least, 2.0, 50) == Ruling::holds);
  CHECK(ruling(Relation::at_least, 5.0, 50) == Ruling::not_testable);
  CHECK(ruling(Relation::at_least, 5.0, 1) == Ruling::fails);  // one of 100 lies outside the interval
  CHECK(ruling(Relation::at_most, 2.6, 50) == Ruling::undecided);
}

TEST_CASE("what policies share cancels in their difference, and the finding is that difference") {
  const Finding finding = judged("at(r('lqr'), 0) > at(r('ppo'), 0)");

  CHECK(finding.verdict.ruling == Ruling::holds);
  CHECK(finding.measured.estimate == doctest::Approx(0.2).epsilon(1e-12));
  CHECK(finding.measured.low == doctest::Approx(0.2).epsilon(1e-12));
}

TEST_CASE("what is wrong with a formula is said with its column") {
  const std::string head = "study:3:9: claim '";

  CHECK(problem("1 +") == head + "1 +', column 4: expected a number, a 'text', a name or a function");
  CHECK(problem("are(r('ppo'))") == head + "are(r('ppo'))', column 1: unknown function 'are'; did you mean 'area'?");
  CHECK(problem("r('pop')") == head + "r('pop')', column 1: unknown policy 'pop'");
  CHECK(problem("min(x for x in agnets)") ==
        head + "min(x for x in agnets)', column 16: unknown name 'agnets'; did you mean 'agents'?");
  CHECK(problem("1 + 'a'") == head + "1 + 'a'', column 3: '+' needs a number, got text");
  CHECK(problem("at(r('ppo'))") == head + "at(r('ppo'))', column 1: 'at' is called as at(curve, place)");
  CHECK(problem("'open") == head + "'open', column 1: the quoted text has no end");
  CHECK(problem("1 ; 2") == head + "1 ; 2', column 3: ';' means nothing here");
  CHECK(problem("(1").ends_with("column 3: expected ')'"));
  CHECK(problem("1 2").ends_with("column 3: expected nothing more"));
  CHECK(problem("area([1, 2])").ends_with("'area' needs a curve: scores along levels, or along another number"));
  CHECK(problem("[x for x in 3]").ends_with("'for' needs a list, got a number"));
  CHECK(problem(std::string(100, '(') + "1").find("nested too deep") != std::string::npos);
  CHECK(problem("1 ≥ 2").ends_with("column 3: '≥' means nothing here"));
  std::string sum = "1";
  for (int i = 0; i < 1'000; ++i) sum += " + 1";
  CHECK(number(sum) == 1001.0);
  CHECK(problem(sum + " + 1").ends_with("too long; at most 1000 operators side by side"));
  const std::string list = "[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]";
  CHECK(problem("count(a > b for a in " + list + " for b in " + list + " for c in " + list + " for d in " + list + ")")
            .ends_with("makes too many items; at most 10000 in a formula"));
  CHECK(problem("[1e999]").ends_with("expected a finite number"));
}

TEST_CASE("a formula knows the functions that it calls, wherever they stand") {
  const Formula formula("all(alike (mean(r(a)), 1, 0.1) for a in agents) or not 1 > 2", {"study"});
  CHECK(formula.calls("alike"));
  CHECK(formula.calls("mean"));
  CHECK_FALSE(formula.calls("agents"));
  CHECK_FALSE(formula.calls("min"));
}

TEST_CASE("a claim must be a statement") {
  CHECK_THROWS_WITH(judged("area(r('ppo'))"),
                    "study: claim 'area(r('ppo'))', column 1: a claim is a statement such as a > b, this is a number");
}

TEST_CASE("docs/study.md lists every function as the program has it") {
  std::ifstream file(GUST_TEST_DATA "/../docs/study.md");
  const std::string text(std::istreambuf_iterator<char>(file), {});

  for (const FormulaFunction& function : formula_functions()) {
    const std::string row = cat("| `", function.name, "(", function.arguments, ")` | ", function.summary, " |\n");
    CAPTURE(row);
    CHECK(text.find(row) != std::string::npos);
  }
}
