#include "gust/study/summary/claim_scores.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "gust/stats/aggregate.h"
#include "gust/study/summary/summary.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/run.h"
#include "gust/study/trials/trials.h"

using namespace gust;
using namespace gust::test;

namespace {

const char* const kClaim = "[[claim]]\nid = \"falls\"\nwhere = { policy = \"nothing\" }\nholds = \"survival <= 0.8\"\n";

/// The small study with a claim that is a formula, run.
struct RunStudy {
  ScratchFolder folder;
  Study study;
  Store store;
  Plan plan;
  Summary summary;

  RunStudy(const std::string& name, const std::string& claim)
      : folder(name),
        study(small_study({}, changed(kClaim, claim))),
        store(folder.path / "store", Store::Access::write),
        plan(run_study(study, store, {.threads = 1, .stop = {}, .watch = {}}).plan),
        summary(summarise(*stored_measurements(study, plan, store), 1)) {}

  FormulaValue value(std::string_view text, const ClaimView& view) const {
    const auto measured = stored_measurements(study, plan, store);
    const ClaimScores scores({{&study, measured.get()}}, view, Rng(1));
    return Formula(text, {"test"}).evaluate(study.names, scores);
  }
};

std::string problem_of(const std::string& claim) {
  try {
    small_study({}, changed(kClaim, claim));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}
std::string formula(const std::string& holds) { return "[[claim]]\nid = \"f\"\nholds = \"" + holds + "\"\n"; }

}  // namespace

TEST_CASE("a study's formulas are judged on its scores") {
  const RunStudy run("gust-claims", "[names]\nall = [\"lqr\", \"nothing\"]\n" +
                                        formula("min(area(score('lqr', 'push')) - score(p) for p in all) > -1") +
                                        "[[claim]]\nid = \"g\"\nholds = \"score('nothing') >= score('lqr')\"\n");

  REQUIRE(run.summary.claims.size() == 2);
  CHECK(run.summary.claims[0].finding.verdict.ruling == Ruling::holds);
  CHECK(run.summary.claims[1].finding.verdict.ruling == Ruling::fails);
  CHECK(run.summary.claims[1].finding.measured.estimate < 0);
  CHECK(run.summary.claims[1].finding.measured.high < 0);
}

TEST_CASE(
    "a bound said with where and as a formula has one interval and one verdict, for every metric, place and start") {
  std::string claims = "[[sweep]]\nname = \"both\"\ngrid = { pole_length = [0.4, 0.5], pole_mass = [0.1, 0.2] }\n";
  struct Said {
    std::string where, formula;
  };
  const Said places[] = {{"policy = \"POLICY\"", "METRIC('POLICY')"},
                         {"policy = \"POLICY\", sweep = \"push\", level = 5", "at(METRIC('POLICY', 'push'), 5)"},
                         {"policy = \"POLICY\", sweep = \"noise\", level = 1", "at(METRIC('POLICY', 'noise'), 1)"},
                         {"policy = \"POLICY\", sweep = \"both\", pole_length = 0.5, pole_mass = 0.2",
                          "at(METRIC('POLICY', 'both', 0.5), 0.2)"}};
  const auto filled = [](std::string text, const std::string& policy, const std::string& metric) {
    for (const auto& [name, value] : {std::pair{std::string("POLICY"), policy}, {std::string("METRIC"), metric}}) {
      for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name))
        text.replace(at, name.size(), value);
    }
    return text;
  };
  std::size_t count = 0;
  for (const char* start : {"random", "nominal"}) {
    for (const char* metric : {"survival", "anr_h", "length", "saturation"}) {
      for (const char* policy : {"lqr", "nothing"}) {
        for (const Said& said : places) {
          for (const char* bound : {" >= 0.99", " < 0.5"}) {
            claims +=
                cat("[[claim]]\nid = \"w", count, "\"\nwhere = { ", filled(said.where, policy, metric), ", start = \"",
                    start, "\" }\nholds = \"", metric, bound, "\"\n[[claim]]\nid = \"f", count, "\"\nstart = \"", start,
                    "\"\nholds = \"", filled(said.formula, policy, metric), bound, "\"\n");
            ++count;
          }
        }
      }
    }
  }
  const RunStudy run("gust-claims-one-verdict", claims);

  REQUIRE(run.summary.claims.size() == 2 * count);
  std::size_t undecided = 0;
  for (std::size_t i = 0; i < 2 * count; i += 2) {
    const Finding &where = run.summary.claims[i].finding, &formula = run.summary.claims[i + 1].finding;
    CAPTURE(run.summary.claims[i + 1].claim->holds);
    CHECK(measured_text(where) == measured_text(formula));
    CHECK(where.verdict.ruling == formula.verdict.ruling);
    CHECK(where.verdict.reason == formula.verdict.reason);
    CHECK((where.measured.low == formula.measured.low || std::isnan(where.measured.low)));  // else the text differs
    undecided += where.verdict.ruling == Ruling::undecided ? 1 : 0;
  }
  CHECK(undecided > 0);
  const Finding& three = run.summary.claims[0].finding;  // survival of lqr: 3 of 3
  CHECK(three.measured.low == doctest::Approx(3 / (3 + 1.959964 * 1.959964)).epsilon(1e-4));
  CHECK(measured_text(three) == "1 [0.4385, 1] (3 episodes; about 390 episodes would decide)");
}

TEST_CASE("scores are those of the summary, metric by metric and start by start") {
  const RunStudy run("gust-claims-scores", kClaim);
  const std::size_t anr = run.study.metric_set.index("anr", {});

  for (const std::size_t start : {0u, 1u}) {
    const FormulaValue curve = run.value("anr('lqr', 'push')", {"anr_h", run.study.starts[start].name});
    const std::vector<Sampled> cells = curve.as_numbers("a test");
    REQUIRE(cells.size() == 3);
    for (std::size_t cell = 0; cell < 3; ++cell)
      CHECK(cells[cell].estimate() ==
            doctest::Approx(run.summary.find(0, 0, start)->at(anr, cell).value).epsilon(1e-14));
  }
}

TEST_CASE("what all resamples share cancels: a policy does not differ from itself") {
  const RunStudy run("gust-claims-self", kClaim);

  const FormulaValue zero = run.value("score('lqr', 'push')", {"anr_h", "random"});
  const Interval apart = interval_of(
      run.value("at(anr('lqr', 'push'), 5) - at(anr('lqr', 'push'), 5)", {"anr_h", "random"}).as_number("a test"));

  CHECK(zero.as_list("a test").axis == std::vector<double>{0, 5, 30});
  CHECK(apart.low == 0.0);
  CHECK(apart.high == 0.0);
}

TEST_CASE("the fixed start has one episode, which says nothing about others") {
  const RunStudy run("gust-claims-fixed",
                     "[[claim]]\nid = \"f\"\nstart = \"nominal\"\nholds = \"score('lqr') > 0.5\"\n");

  REQUIRE(run.summary.claims.size() == 1);
  CHECK(run.summary.claims[0].finding.verdict.ruling == Ruling::not_testable);
  CHECK(run.summary.claims[0].finding.verdict.reason.ends_with(
      "every episode from this start is the same one; a random start would give an interval"));
}

TEST_CASE("a grid is read row by row") {
  const std::string grid =
      "[[sweep]]\nname = \"both\"\ngrid = { pole_length = [0.4, 0.5], pole_mass = [0.1, 0.2, 0.4] }\n";
  const RunStudy run("gust-claims-grid", grid + kClaim);

  CHECK(run.value("score('lqr', 'both')", {"anr_h", "random"}).as_numbers("a test").size() == 6);
  CHECK(run.value("score('lqr', 'both', 0.5)", {"anr_h", "random"}).as_list("a test").axis ==
        std::vector<double>{0.1, 0.2, 0.4});
  CHECK(run.value("values('both')", {"anr_h", "random"}).as_list("a test").axis == std::vector<double>{0.4, 0.5});
  CHECK_THROWS_WITH(run.value("score('lqr', 'both', 0.6)", {"anr_h", "random"}),
                    doctest::Contains("has no pole_length of 0.6"));
}

TEST_CASE("margin() is the summary's margin: from the undisturbed score, and not testable where there is none") {
  std::string sweeps;
  for (const auto& [name, wind] : {std::pair("worn", 0.2), std::pair("spent", 2.0)})
    sweeps +=
        cat("[[sweep]]\nname = \"", name, "\"\nsite = \"action\"\nwaveform = { kind = \"step\", offset = 2 }\n",
            "levels = [0, 5, 30]\ndisturb = [{ site = \"dynamics\", waveform = \"white\", level = ", wind, " }]\n");
  const RunStudy run("gust-claims-margin", sweeps + formula("margin(score('nothing', 'push')) > 1"));
  const ClaimView view{"anr_h", "random"};

  const auto told = [&](const std::string& what) { return run.value(what, view).as_number("test"); };
  const auto shown = [&](std::size_t sweep) { return run.summary.find(0, sweep, 1)->margin.level.estimate; };

  CHECK(told("margin(score('lqr', 'push'))").estimate() == doctest::Approx(shown(0)).epsilon(1e-12));
  CHECK(told("margin(score('lqr', 'worn'))").estimate() == doctest::Approx(shown(2)).epsilon(1e-12));
  CHECK(shown(2) < 0.7 * shown(0));
  CHECK(told("margin(score('lqr', 'spent'))").estimate() == 0.0);
  CHECK(told("half(score('lqr', 'spent'))").estimate() == 0.0);
  CHECK(shown(3) == 0.0);
  CHECK_THROWS_WITH_AS(run.value("margin(score('nothing', 'push'))", view),
                       doctest::Contains("there is no margin: it fails undisturbed"), NotTestable);
  CHECK(run.summary.claims.front().finding.verdict.ruling == Ruling::not_testable);
}

TEST_CASE("what is missing in the store makes a claim not testable") {
  const ScratchFolder folder("gust-claims-missing");
  Study study = small_study({}, changed(kClaim, formula("score('lqr') > 0.5")));
  const Store store(folder.path / "store", Store::Access::write);

  const Summary summary = summarise(*stored_measurements(study, plan_with_store(study, store), store), 1);

  REQUIRE(summary.claims.size() == 1);
  CHECK(summary.claims[0].finding.verdict.ruling == Ruling::not_testable);
  CHECK(summary.claims[0].finding.verdict.reason.find("not measured: ") == 0);
}

/// Puts a training into the store that ended without a policy.
void store_failure(const Store& store, const Trial& training) {
  TrialWriter writer = store.begin(kind_name(training.kind), training.id);
  writer.write(kCurveFile, curve_text({{0, 1, 0, 30, 0.5, 0.125, 0.75}}));
  writer.write(kFailureFile, "a loss is not finite");
  writer.commit(training.canonical);
}

std::string trained(const std::string& name, const std::string& seeds, const std::string& options) {
  return "[[policy]]\nname = \"" + name + "\"\nkind = \"train\"\nseeds = " + seeds +
         "\nagent = { kind = \"ppo\", hidden = 8, " + options + " }\n";
}

TEST_CASE("a seed whose training failed is left out of scores, curves and levels, and is not counted") {
  const ScratchFolder folder("gust-claims-failed");
  std::string text = changed(kClaim, formula("score('p') > -1"));
  text.replace(text.find("levels = [0, 5, 30]"), 19, "levels = \"auto\"");
  text.insert(text.find("[[policy]]"), trained("p", "[1, 2, 3]", "steps = 1_200") +
                                           trained("longer", "[3, 2, 1]", "steps = 1_600") +
                                           trained("other", "[1, 2]", "steps = 1_200, discount = 0.9") +
                                           trained("broken", "[1]", "steps = 1_200, discount = 0.8"));
  Study study = small_study({}, text);
  const Store store(folder.path / "store", Store::Access::write);
  const Plan plan = expand(study, {});
  store_failure(store, plan.trials[1]);  // of 'p', seed 2
  store_failure(store, plan.trials[8]);  // of 'broken'

  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});

  CHECK(outcome.plan.complete);
  CHECK(outcome.outcomes[1].state == Outcome::State::failed);
  const auto skipped = std::ranges::find(outcome.outcomes, Outcome::State::skipped, &Outcome::state);
  REQUIRE(skipped != outcome.outcomes.end());
  CHECK(skipped->reason == "its training failed: a loss is not finite");

  const auto measured = stored_measurements(study, outcome.plan, store);
  const ClaimScores scores({{&study, measured.get()}}, {"anr_h", "random"}, Rng(1));
  const auto ask = [&](const char* formula) { return Formula(formula, {"test"}).evaluate(study.names, scores); };
  const Summary summary = summarise(*measured, 1);
  const std::size_t random = study.starts[0].random ? 0 : 1;
  CHECK(ask("score('p')").as_number("a test").estimate() ==
        doctest::Approx(summary.undisturbed(0, random)).epsilon(1e-12));
  CHECK(scores.fewest_seeds() == 2);
  CHECK(ask("score('longer')").as_number("a test").estimate() != summary.undisturbed(1, random));  // without seed 2
  CHECK(scores.fewest_seeds() == 2);
  CHECK(ask("score('p', 'push')").as_list("a test").axis.size() == 11);
  CHECK(ask("curve('p')").as_list("a test").axis.size() > 1);  // not cut to the failed one's
  CHECK(scores.fewest_seeds() == 2);
  CHECK_THROWS_WITH_AS(ask("score('broken')"), "no training of 'broken' ended with a policy", NotTestable);

  const ClaimScores ones({{&study, measured.get()}}, {.metric = "anr_h", .start = "random", .one_training = true},
                         Rng(1));
  const auto draws = [&](const char* formula) {
    const FormulaValue value = Formula(formula, {"test"}).evaluate(study.names, ones);
    return std::set<double>(value.as_number("a test").values.begin() + 1, value.as_number("a test").values.end());
  };
  CHECK(draws("score('p')").size() == 2);                    // one training or the other
  CHECK(draws("score('p') + anr('p')").size() == 2);         // the same one wherever it is asked for
  CHECK(draws("score('p') - score('longer')").size() == 2);  // nor otherwise where the other goes on from it
  CHECK(draws("score('p') - score('other')").size() == 4);   // others are drawn by themselves
  CHECK(draws("score('lqr')").size() > 2);                   // what has no seeds has episodes

  const std::set<double> p = draws("score('p')"), other = draws("score('other')");
  double pairs = 0;  // the probability of improvement of p over other, pair by pair
  for (const double a : p)
    for (const double b : other) pairs += a > b ? 1.0 / static_cast<double>(p.size() * other.size()) : 0.0;
  const FormulaValue difference = Formula("score('p') - score('other')", {"test"}).evaluate(study.names, ones);
  const std::vector<double>& values = difference.as_number("a test").values;
  const auto ahead = std::count_if(values.begin() + 1, values.end(), [](double value) { return value > 0; });
  CHECK(std::abs(static_cast<double>(ahead) / static_cast<double>(values.size() - 1) - pairs) < 0.05);
}

TEST_CASE("trainings may count by their median; episodes never do") {
  const ScratchFolder folder("gust-claims-median");
  std::string text = changed(kClaim, formula("score('p') > -1"));
  text.insert(text.find("[[policy]]"), trained("p", "[1, 2, 3]", "steps = 1_200"));
  Study study = small_study({}, text);
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});
  const auto measured = stored_measurements(study, outcome.plan, store);
  const auto ask = [&](const char* formula, const ClaimView& view) {
    const ClaimScores scores({{&study, measured.get()}}, view, Rng(1));
    return Formula(formula, {"test"}).evaluate(study.names, scores).as_number("a test").values;
  };
  const ClaimView means{.metric = "anr_h", .start = "random"};
  const ClaimView medians{.metric = "anr_h", .start = "random", .over_seeds = Statistic::median};
  const std::vector<double> ones = ask("score('p')", {.metric = "anr_h", .start = "random", .one_training = true});
  const std::set<double> seeds(ones.begin() + 1, ones.end());

  REQUIRE(seeds.size() == 3);
  CHECK(ask("score('p')", medians).front() == *std::next(seeds.begin()));
  CHECK(ask("score('p')", means).front() == doctest::Approx(std::accumulate(seeds.begin(), seeds.end(), 0.0) / 3));
  for (const double drawn : ask("score('p')", medians)) CHECK(seeds.contains(drawn));  // of three the median is one
  CHECK(ask("last(curve('p'))", medians) != ask("last(curve('p'))", means));
  CHECK(ask("score('lqr')", medians) == ask("score('lqr')", means));
}

TEST_CASE("what is wrong with a formula is said when the study is read") {
  CHECK(problem_of(formula("score('lqr', 'psh') > 0")).find("policy 'lqr' has no sweep 'psh'; did you mean 'push'?") !=
        std::string::npos);
  CHECK(problem_of(formula("score('lqq') > 0")).find("small.toml:31:9: claim") == 0);
  CHECK(problem_of(formula("curve('lqr') > 0")).find("'lqr' is not trained") != std::string::npos);
  CHECK(problem_of(formula("score('lqr')")).find("a claim is a statement") != std::string::npos);
  CHECK(problem_of("[[policy]]\nname = \"p\"\nkind = \"train\"\nagent = { kind = \"ppo\" }\n" +
                   formula("last(curve('p', 'anr_g')) > 0"))
            .find("a learning curve has no 'anr_g'; did you mean 'anr_h'?") != std::string::npos);
  CHECK(problem_of(formula("at(score('lqr', 'push'), 31) > 0"))
            .find("claim 'at(score('lqr', 'push'), 31) > 0': 31 lies beyond the levels, 0 to 30") != std::string::npos);
  CHECK(problem_of(formula("survival >= 0.8"))
            .find("whose survival? It needs where = { policy = … }, or "
                  "survival('POLICY')") != std::string::npos);
  CHECK(problem_of("[[claim]]\nid = \"f\"\nholds = \"\"\"\n  score('lqr')\n    > 'a'\n\"\"\"\n")
            .find("claim 'score('lqr') > 'a'', column 14: ") != std::string::npos);
  CHECK(problem_of(formula("survivl('lqr') > 0")).find("did you mean 'survival'?") != std::string::npos);
  CHECK(problem_of(formula("score('lqr', 'push', 5) > 0")).find("at(score(…), level)") != std::string::npos);
  CHECK(problem_of(formula("score('lqr') > 0") + "start = \"somewhere\"\n").find("unknown start") != std::string::npos);
  CHECK(problem_of(formula("score('lqr') > 0") + "metric = \"anx\"\n").find("anx") != std::string::npos);
  CHECK(problem_of(std::string(kClaim) + "metric = \"anr\"\n").find("is for a claim without 'where'") !=
        std::string::npos);
  CHECK(problem_of("[names]\nx = true\n" + formula("1 > 0")).find("a name") != std::string::npos);
}

TEST_CASE("margin() in a claim is the margin of the table, or not testable where the table has none") {
  const RunStudy run("gust-claims-margins", R"(
[[sweep]]
name = "windy"
site = "action"
waveform = { kind = "step", offset = 2 }
levels = [0, 5, 30]
disturb = [{ site = "dynamics", waveform = "step", channels = ["fx"], level = 0.2 }]
[[sweep]]
name = "high"
site = "action"
waveform = { kind = "step", offset = 2 }
levels = [25, 30]
[[claim]]
id = "fails undisturbed"
start = "random"
holds = "margin(score('nothing', 'push')) >= 0.001"
[[claim]]
id = "wind"
holds = "margin(score('lqr', 'windy')) == 0"
[[claim]]
id = "above 0"
holds = "margin(score('lqr', 'high')) < 25"
[[claim]]
id = "push"
holds = "margin(score('lqr', 'push')) >= 5"
)");

  const auto finding = [&](std::size_t claim) -> const Finding& { return run.summary.claims[claim].finding; };
  const Margin& table = run.summary.find(0, 0, 1)->margin;
  CHECK(finding(3).measured.low == table.level.low);
  CHECK(finding(3).measured.high == table.level.high);
  CHECK(finding(3).measured.n == table.level.n);
  CHECK(finding(0).verdict.ruling == Ruling::not_testable);
  CHECK(finding(0).verdict.reason == "there is no margin: it fails undisturbed: 0 % of the episodes last to the end");
  CHECK(finding(1).measured.estimate == 0.0);
  CHECK(finding(1).measured.estimate == run.summary.find(0, 2, 1)->margin.level.estimate);
  CHECK(finding(2).verdict.ruling == Ruling::holds);
  CHECK(finding(2).measured.estimate ==
        doctest::Approx(run.summary.find(0, 3, 1)->margin.level.estimate).epsilon(1e-12));
}

TEST_CASE("a claim about the margin of levels on both sides of 0, or of one level, is refused before any work") {
  const auto problem = [](const std::string& levels, const std::string& holds) {
    return problem_of("[[sweep]]\nname = \"odd\"\nsite = \"action\"\nwaveform = \"step\"\nlevels = " + levels + "\n" +
                      formula(holds));
  };

  CHECK(problem("[-5, 5]", "margin(score('lqr', 'odd')) >= 5").find("both sides of 0") != std::string::npos);
  CHECK(problem("[-5, 5]", "half(score('lqr', 'odd')) >= 5").find("both sides of 0") != std::string::npos);
  CHECK(problem("[5]", "margin(score('lqr', 'odd')) >= 5").find("one level") != std::string::npos);
  CHECK(problem("[-5, 5]", "area(score('lqr', 'odd')) >= 0") == "");
  CHECK(problem("[0, 5]", "margin(score('lqr', 'odd')) >= 5") == "");
}
