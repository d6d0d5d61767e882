#include "gust/paper/reproduction.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <set>

using namespace gust;

TEST_CASE("a miniature trains a share of what a reading says") {
  const Reproduction reproduction =
      open_reproduction(paper_at("paper"), {.profile = "quick", .only = {"table-dr"}, .seeds = 1});
  std::set<std::int64_t> steps;
  for (const ReproductionStudy& part : reproduction.studies)
    steps.insert(part.study.policies[1].training()->agent->steps());
  CHECK(steps == std::set<std::int64_t>{100'000, 500'000});
}

TEST_CASE("the paper has its 74 claims, and each can be asked under each reading that bears on it") {
  const Paper& paper = paper_at("paper");
  const Reproduction reproduction = open_reproduction(paper, {});

  REQUIRE(paper.claims.size() == 74);
  for (std::size_t i = 0; i < paper.claims.size(); ++i) CHECK(paper.claims[i].id == cat("C", i + 1));
  CHECK_NOTHROW(check_claims(reproduction));
}

TEST_CASE("a place beyond the levels is a mistake before any work, whichever reading asks for it") {
  const Paper& paper = paper_at("paper");
  Reproduction reproduction = open_reproduction(paper, {.profile = "quick", .only = {"one-grid"}, .seeds = 1});
  for (ReproductionStudy& part : reproduction.studies) {
    Sweep& sweep = *std::ranges::find(part.study.sweeps, "action step, one grid", &Sweep::name);
    std::erase_if(sweep.axes.front().values, [](double level) { return level > 4; });
  }

  CHECK_THROWS_WITH_AS(check_claims(reproduction), "C15, authors' scripts: 5 lies beyond the levels, 0 to 3", Error);
}

TEST_CASE("medians of trainings bear on every claim that asks for trainings, by whatever name") {
  const Paper& paper = paper_at("paper");
  const Reproduction reproduction = open_reproduction(paper, {.profile = "quick", .only = {"sawtooth"}, .seeds = 1});
  const Plan nothing;
  const std::filesystem::path nowhere = std::filesystem::temp_directory_path() / "gust-no-such-store-either";
  const Store store(nowhere, Store::Access::write);
  std::vector<std::unique_ptr<Measurements>> measured;
  for (const ReproductionStudy& part : reproduction.studies)
    measured.push_back(stored_measurements(part.study, nothing, store));
  std::set<std::string> asked;
  for (const PaperVerdict& verdict : judge_paper(reproduction, measured, 1)) {
    if (paper.readings[verdict.reading].median) asked.insert(paper.claims[verdict.claim].id);
  }
  std::filesystem::remove_all(nowhere);

  CHECK(asked == std::set<std::string>{"C23", "C24", "C25", "C26"});  // C25 asks for survival
}

TEST_CASE("more seeds than the studies have are no miniature") {
  const Paper& paper = paper_at("paper");
  CHECK_FALSE(open_reproduction(paper, {.only = {"learning-curves"}, .seeds = 10}).fewer_seeds);
  CHECK(open_reproduction(paper, {.only = {"learning-curves"}, .seeds = 9}).fewer_seeds);
}

TEST_CASE("a reading speaks of claims, figures and readings that there are") {
  constexpr std::string_view kHead = R"(
schema = 1
name = "p"
title = "P"
source = "S"
[[profile]]
name = "paper"
[[reading]]
name = "main"
says = "As it is."
[[reading]]
name = "other"
says = "Otherwise."
)";
  constexpr std::string_view kFigure =
      "[[figure]]\nstudy = \"white\"\nplace = \"Figure 3\"\ntitle = \"W\"\nsays = \"N.\"\n";
  constexpr std::string_view kClaims = "[[claim]]\nid = \"C1\"\nfigure = \"white\"\ntext = \"so\"\nholds = \"1 > 0\"\n";
  const auto problem = [&](std::string_view reading, std::string_view figure = "") -> std::string {
    try {
      const std::map<std::string, std::string> files = {{"paper.toml", cat(kHead, reading, kFigure, figure)},
                                                        {"claims.toml", std::string(kClaims)},
                                                        {"white.toml", ""},
                                                        {"x.toml", ""}};
      const auto read = [&](const std::string& name) -> std::optional<std::string> {
        const auto at = files.find(name);
        return at == files.end() ? std::nullopt : std::optional(at->second);
      };
      parse_paper({.folder = "p", .read = read, .find = {}});
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  const auto told = [](const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; };

  CHECK(problem("like = \"main\"\n", "reading = \"other\"\n").empty());
  CHECK(told(problem("claims = [\"C2\"]\n"), "the reading 'other' speaks of C2, which is no claim"));
  CHECK(told(problem("like = \"mian\"\n"), "unknown reading 'mian'; did you mean 'main'?"));
  CHECK(told(problem("like = \"other\"\n"), "unknown reading 'other'"));  // it comes before
  CHECK(told(problem("", "reading = \"mein\"\n"), "unknown reading 'mein'"));
  CHECK(told(problem("files = { step = \"x\" }\n"), "unknown study 'step'"));
}

TEST_CASE("the claims of the tables hold or fail in the paper's own numbers as its authors say") {
  const Paper& paper = paper_at("paper");
  const Reproduction reproduction = open_reproduction(
      paper, {.profile = "quick", .only = {"table-dr", "table-adversary", "table-cvar"}, .seeds = {}});
  const Plan nothing;
  std::set<std::string> hold, fail;
  const std::filesystem::path nowhere = std::filesystem::temp_directory_path() / "gust-no-such-store";
  const Store store(nowhere, Store::Access::write);
  std::vector<std::unique_ptr<Measurements>> measured;
  for (const ReproductionStudy& part : reproduction.studies)
    measured.push_back(stored_measurements(part.study, nothing, store));
  for (const PaperVerdict& verdict : judge_paper(reproduction, measured, 2)) {
    if (!paper.readings[verdict.reading].printed) {
      CHECK(verdict.verdict.ruling == Ruling::not_testable);  // nothing was measured
      continue;
    }
    (verdict.verdict.ruling == Ruling::holds ? hold : fail).insert(paper.claims[verdict.claim].id);
  }
  std::filesystem::remove_all(nowhere);

  CHECK(hold ==
        std::set<std::string>{"C58", "C59", "C60", "C61", "C62", "C63", "C64", "C65", "C66", "C67", "C68", "C72"});
  CHECK(fail.empty());
}

TEST_CASE("a profile changes seeds and steps of every training, a reading the plant") {
  const Paper& paper = paper_at("paper");
  const Reproduction reproduction =
      open_reproduction(paper, {.profile = "quick", .only = {"learning-curves", "white"}, .seeds = {}});

  // Two of the main reading, of its authors', of scg-default, of RAP goes on and of RARL at 0.01; white under three
  // more.
  REQUIRE(reproduction.studies.size() == 13);
  CHECK(reproduction.studies[0].study.policies[1].training()->seeds == std::vector<std::int64_t>{1, 2});
  CHECK(reproduction.studies[0].study.policies[1].training()->agent->steps() == 100'000);
  CHECK(reproduction.studies[2].study.policies[4].training()->agent.canonical().find("site = \"dynamics\"") !=
        std::string::npos);
  CHECK(reproduction.studies[2].study.starts[0].name == "x=0.55 theta=0.3");
  CHECK(reproduction.studies[4].study.setup.preset == "scg-default");
  CHECK(reproduction.find(1, "white") == 3);
  CHECK(reproduction.find(paper.reading("return / horizon"), "white") == 1);    // it leaves the studies alone
  CHECK(reproduction.find(paper.reading("starts of training"), "white") == 3);  // it is like its authors'
  CHECK(paper.readings[paper.reading("starts of training")].claims == paper.readings[1].claims);
  CHECK_FALSE(reproduction.find(0, "step").has_value());
  const Reproduction more = open_reproduction(paper, {.profile = "paper", .only = {"white"}, .seeds = 3});
  CHECK(more.studies[0].study.policies[1].training()->seeds == std::vector<std::int64_t>{1, 2, 3});
}

TEST_CASE("a premise bears on the parts that speak of it, in its claims") {
  const Paper& paper = paper_at("paper");
  REQUIRE(paper.premises.size() == 1);
  const PaperPremise& raac = paper.premises.front();

  CHECK(raac.bears_on("C47", {"mean(score('raac', w)) > mean(score(a, w))", "a = ppo, w = tap", {}}));
  CHECK(raac.bears_on("C66", {"mean(score('RAAC 0.3', r)) < 1", "", {}}));
  CHECK(raac.bears_on("C42", {"mean(score('ppo-dr', w)) < mean(score(a, w))", "a = raac, w = tap", {}}));
  CHECK_FALSE(raac.bears_on("C42", {"mean(score('ppo-dr', w)) < mean(score(a, w))", "a = rap, w = tap", {}}));
  CHECK_FALSE(raac.bears_on("C50", {"mean(score('raac', w)) > 1", "", {}}));  // that is the quadrotor
}

TEST_CASE("a verdict is graded by its parts") {
  CHECK(grade_of(Ruling::holds, 8, 8, 0) == Grade::shown);
  CHECK(grade_of(Ruling::holds, 8, 8, 2) == Grade::shown);
  CHECK(grade_of(Ruling::fails, 8, 7, 0) == Grade::refuted_in_part);
  CHECK(grade_of(Ruling::fails, 8, 0, 0) == Grade::refuted);
  CHECK(grade_of(Ruling::fails, 1, 0, 0) == Grade::refuted);
  CHECK(grade_of(Ruling::undecided, 8, 7, 0) == Grade::open);
  CHECK(grade_of(Ruling::not_testable, 0, 0, 3) == Grade::not_comparable);
  CHECK(grade_of(Ruling::not_testable, 0, 0, 0) == Grade::not_testable);
  CHECK(grade_name(Grade::refuted_in_part) == "refuted in part");
}

TEST_CASE("what is not known of a paper is an error with what is") {
  const Paper& paper = paper_at("paper");
  CHECK_THROWS_WITH_AS(paper_at("papers"), doctest::Contains("did you mean 'paper'?"), Error);
  CHECK_THROWS_WITH_AS(open_reproduction(paper, {.profile = "quik", .only = {}, .seeds = {}}),
                       "unknown profile 'quik'; did you mean 'quick'?; there are paper, quick", Error);
  CHECK_THROWS_WITH_AS(open_reproduction(paper, {.profile = "quick", .only = {"whit"}, .seeds = {}}),
                       doctest::Contains("unknown figure 'whit'; did you mean 'white'?"), Error);
  for (const std::int64_t seeds : {0L, -3L, 2'000'000'000L}) {
    CHECK_THROWS_WITH_AS(open_reproduction(paper, {.profile = "quick", .only = {}, .seeds = seeds}),
                         doctest::Contains("1 to 10000 seeds"), Error);
  }
}
