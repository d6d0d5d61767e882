#include "gust/paper/reproduction_results.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "gust/study/text/study_fixture.h"

using namespace gust;

namespace {

/// A series whose episodes all stand and score 1, but at the last level, where all have fallen.
Series invented(const Study& study, std::size_t policy, std::size_t sweep, std::size_t start) {
  Series series{.policy = policy, .sweep = sweep, .start = start};
  series.cells = sweep == Trial::kNominal ? 1 : study.sweeps[sweep].cells();
  series.metrics = summarised_metrics(study);
  series.unit = Unit::seeds;
  series.units = 5;
  for (const std::size_t metric : series.metrics) {
    const std::string& name = study.metric_set.name(metric);
    for (std::size_t cell = 0; cell < series.cells; ++cell) {
      const bool fallen = sweep != Trial::kNominal && cell + 1 == series.cells;
      double value = fallen ? 0.0 : 1.0;
      if (name == "anr" && fallen) value = 0.5;
      if (name == "anr_h" && fallen) value = 0.125;
      if (name == "saturation") value = fallen ? 0.25 : 0.0;
      series.values.push_back({value, value, value});
    }
  }
  series.has_margin = sweep != Trial::kNominal;
  const bool regulator = series.has_margin && study.policies[policy].kind == "lqr";
  const double level = regulator && study.sweeps[sweep].name == "action white" ? 1.0 : 2.0;
  series.margin.level = {level, level, level, Unit::seeds, 5};
  return series;
}

/// What a run of one figure might have found, but for verdicts.
PaperResults invented_results_of(const std::string& figure) {
  PaperResults results{open_reproduction(paper_at("paper"), {.profile = "paper", .only = {figure}, .seeds = 5}),
                       {},
                       {},
                       {"train ppo seed 1 failed: a reason | with a bar"},
                       {{"gust", "test"}}};
  for (const ReproductionStudy& part : results.reproduction.studies) {
    Summary& summary = results.summaries.emplace_back();
    summary.margin_metric = margin_metric(part.study);
    for (std::size_t policy = 0; policy < part.study.policies.size(); ++policy) {
      for (std::size_t start = 0; start < 2; ++start) {
        summary.series.push_back(invented(part.study, policy, Trial::kNominal, start));
        for (std::size_t sweep = 0; sweep < part.study.sweeps.size(); ++sweep)
          summary.series.push_back(invented(part.study, policy, sweep, start));
      }
    }
  }
  return results;
}

/// What a run of Figure 3 might have found.
PaperResults invented_results() {
  PaperResults results = invented_results_of("white");
  const auto found = [&](std::size_t claim, std::size_t reading, Ruling ruling) {
    results.verdicts.push_back({claim, reading, {0.5, 0.25, 0.75}, {ruling, "a reason"}, 5, 0.25});
  };
  found(5, 0, Ruling::holds);  // C6
  found(5, 1, Ruling::fails);
  found(6, 0, Ruling::fails);  // C7
  results.verdicts.back().parts = 4;
  results.verdicts.back().true_parts = 3;
  found(6, 1, Ruling::undecided);
  found(7, 0, Ruling::undecided);  // C8
  return results;
}

bool says(const std::vector<std::string>& sentences, std::string_view part) {
  return std::ranges::any_of(sentences, [&](const std::string& s) { return s.find(part) != std::string::npos; });
}

}  // namespace

TEST_CASE("findings count verdicts and say what the numbers say") {
  const PaperResults results = invented_results();
  const auto [opening, sentences] = findings(results);

  CHECK(says(opening, " trainings of 4 agents, and the regulators, were tested under 2 readings of the paper."));
  CHECK(
      says(opening, "Of 3 claims 1 is shown, 1 open, 1 refuted in part; of their 4 parts 3 are true at the estimate."));
  CHECK(says(opening, "3 of 3 claims would hang on the draw"));
  CHECK(says(sentences, "1 claim is shown under one reading of the paper and refuted under another."));
  CHECK(says(sentences, "claims that all trainings refute would have come out true in 25 % of draws on average."));
  CHECK(says(sentences, "(15 cells of policy, waveform, site and level)"));  // five policies, three sites, one level
  CHECK(says(sentences, "still averages 0.50; over the whole horizon it is 0.12"));
  CHECK(says(sentences, "up to 25 % of the control steps (ppo, action white at 10 N)"));
  CHECK(says(sentences, "only in part; undisturbed 0 % for ppo, 0 % for sac, 0 % for rarl, 0 % for rap."));
  CHECK(says(sentences,
             "at least the level of the best agent in 0 of 1 sweeps of disturbed actions, 1 of 1 of dynamics, 1 of 1 "
             "of observations, by the estimates on the cartpole;"));
  CHECK_FALSE(says(sentences, "trains its adversary"));  // no learning curves here
}

TEST_CASE("a regulator that stands to the end of the grid beside the best agent is compared with nobody") {
  PaperResults results = invented_results();
  for (Series& series : results.summaries[0].series) {
    const Study& study = results.reproduction.studies[0].study;
    if (series.sweep == Trial::kNominal || study.sweeps[series.sweep].name != "dynamics white") continue;
    series.margin.censored = study.policies[series.policy].name != "ppo";  // it falls before the end
  }

  CHECK(says(findings(results).further, "in 0 of 1 sweeps of disturbed actions, 1 of 1 of observations"));
}

TEST_CASE("the opening names what was asked before the run, under the reading that decides and the main one") {
  PaperResults results = invented_results();
  results.verdicts.push_back({2, 1, {0.5, 0.25, 0.75}, {Ruling::undecided, ""}, 5});  // C3
  results.verdicts.back().parts = 8;
  results.verdicts.back().true_parts = 8;
  results.verdicts.back().share = 0.9;
  results.verdicts.push_back({2, 0, {0.5, 0.25, 0.75}, {Ruling::fails, ""}, 5});
  results.verdicts.back().parts = 8;
  results.verdicts.back().true_parts = 7;

  CHECK(says(
      opening_findings(results),
      "“Every agent is more robust to disturbed actions than to disturbed dynamics or observations” (C3) is open, "
      "with 8 of 8 parts true, and true in 90 % of resamples of the trainings; under scg-2022 it is refuted in part, "
      "with 7 of 8 parts true."));
}

TEST_CASE("the opening says who decides what, and nothing where the main reading decides all") {
  PaperResults results = invented_results_of("white");
  results.verdicts.push_back({11, 0, {}, {Ruling::fails, ""}, 5});
  CHECK_FALSE(says(opening_findings(results), "decides"));
  for (const std::size_t claim : {0, 1, 2, 3, 10}) results.verdicts.push_back({claim, 1, {}, {Ruling::fails, ""}, 5});
  CHECK(says(opening_findings(results), "‘authors' scripts’ decides C1 to C4 and C11, ‘scg-2022’ the other claims;"));
}

TEST_CASE("the opening says how many verdicts chance alone would give, those aside that were named before") {
  PaperResults results = invented_results_of("white");
  for (std::size_t claim = 2; claim < 12; ++claim) {  // C3 and C4 are primary
    results.verdicts.push_back({claim, 0, {0.5, 0.25, 0.75}, {claim < 6 ? Ruling::holds : Ruling::undecided, ""}, 5});
    results.verdicts.back().parts = 1;
  }

  CHECK(says(opening_findings(results),
             "chance alone would show or refute about 0 of the 8 that were not named before the "
             "run (2 are), and 0 of their 8 verdicts under all readings (2 are); with few seeds it is more."));
}

TEST_CASE(
    "the heat maps say whether it helps to train with the noise of the test, start by start and under both readings") {
  PaperResults results = invented_results_of("training-noise");
  const auto heard = [&] { return opening_findings(results); };
  CHECK(says(heard(),
             "than trained without at 0 of 48 levels (clearly at 0, clearly worse at 0) from the start "
             "of the paper's tests, and at 0 of 48"));  // all equal

  const std::size_t drawn = *results.reproduction.drawn(*results.reproduction.paper->figure("training-noise"));
  const auto set = [&](std::size_t at, const std::string& policy, double value) {
    const Study& changed = results.reproduction.studies[at].study;
    for (Series& series : results.summaries[at].series) {
      if (series.sweep == Trial::kNominal || !changed.policies[series.policy].name.starts_with(policy)) continue;
      if (changed.policies[series.policy].name.ends_with(" 0")) continue;
      for (Estimate& cell : series.values) cell.value = value;
    }
  };
  set(drawn, "ppo dynamics 1.5", 1.5);
  CHECK(says(heard(), "at 1 of 48 levels (clearly"));  // trained with it, tested with it
  CHECK_FALSE(says(heard(), "as printed"));

  set(0, "ppo", 1.5);
  set(0, "rap", 1.5);
  CHECK(says(heard(),
             "; under scg-2022, on its own levels, at 42 of 42 levels (clearly at 0, clearly worse at "
             "0): as printed under the author's settings, the reverse under the others. Undisturbed they average "
             "1.01 from the one start and 1.01 from the others, those trained without noise 1.00 and 1.00."));
}

TEST_CASE("the page and the text of a reproduction hold its figures and claims, and what failed") {
  const PaperResults results = invented_results();
  const ReproductionPage page = reproduction_page(results, "gust reproduce paper");
  REQUIRE(page.figures.size() == 1);
  CHECK(page.figures[0].claims == std::vector<std::string>{"C6", "C7", "C8"});
  CHECK(page.figures[0].page.sweeps.size() == 3);
  CHECK(page.claims[0].verdicts.size() == 2);
  CHECK(page.warnings == results.failures);

  const std::string text = reproduction_text(results, "gust reproduce paper");
  CHECK(text.find("| C6: On the dynamics") != std::string::npos);
  CHECK(text.find(
            "- It is refuted over all seeds, though single trainings of ours show it in 10 to 90 % of draws. 1 claim:\n"
            "  - C7: ") != std::string::npos);
  CHECK(text.find("- It is open, and one training of each policy would show it in 10 to 90 % of draws. 1 claim:\n"
                  "  - C8: ") != std::string::npos);
  CHECK(text.find("| **shown** | 0.5 [0.25, 0.75] | – | 25 % | refuted: authors' scripts |") != std::string::npos);
  CHECK(text.find("| refuted in part | 0.5 [0.25, 0.75] | 3 of 4 | 25 % |") != std::string::npos);
  CHECK(text.find("## What failed\n\n- train ppo seed 1 failed") != std::string::npos);
  CHECK(text.ends_with("bar\n"));
}

TEST_CASE("a figure with learning curves says which are not flat at their ends") {
  PaperResults results = invented_results_of("learning-curves");
  for (std::size_t claim = 0; claim < 2; ++claim)
    results.verdicts.push_back({claim, 0, {0.5, 0.25, 0.75}, {Ruling::holds, ""}, 5, 1});
  const auto trained = [&] { return reproduction_page(results, "gust reproduce paper").figures[0].trained; };
  CHECK(trained() ==
        "Drawn under ‘authors' scripts’. Trained: ppo, rarl, rap: 5 seeds of 1 000 000 steps; sac: 5 seeds of 200 000 "
        "steps.");

  const std::size_t drawn = *results.reproduction.drawn(*results.reproduction.paper->figure("learning-curves"));
  const std::vector<StudyPolicy>& policies = results.reproduction.studies[drawn].study.policies;
  for (std::size_t p = 0; p < policies.size(); ++p) {
    if (!policies[p].training()) continue;
    SeedCurve curve{.policy = p, .points = std::vector<CurvePoint>(7)};
    for (std::size_t i = 1; i < 7; ++i)  // rising to the middle; rarl goes on, by 0.04 a point
      curve.points[i] = {.steps = static_cast<std::int64_t>(i) * 10,
                         .anr_h = policies[p].name == "rarl" ? 0.04 * static_cast<double>(i)
                                  : i < 3                    ? 0.1
                                                             : 0.9};
    results.summaries[drawn].curves.push_back(curve);
  }
  results.summaries[0].curves = results.summaries[drawn].curves;
  CHECK(
      trained().ends_with(" In the last third of the training the return over the horizon changes by +0.080 for rarl, "
                          "and by no more than 0.02 for the others, against the third before."));
  const std::string held =
      "Where nothing disturbs, the share of episodes that last to their end is 100 % for ppo, 100 % for rap, "
      "100 % for rarl, 100 % for sac.";
  CHECK(std::ranges::count(findings(results).further, held) == 1);
  results.summaries[drawn].curves.resize(1);  // of ppo alone
  CHECK(trained().ends_with("changes by no more than 0.02 for any policy, against the third before."));

  results.summaries[drawn].curves[0].points[6].anr_h = 0.5;
  CHECK(
      trained().ends_with("changes by −0.200 for ppo, and by no more than 0.02 for the others, against the third "
                          "before. What is measured is the policy at the end of its training; the mean over "
                          "trainings was higher before: ppo 0.50 after 0.90."));
}

TEST_CASE("what is left of results is what their tables hold") {
  PaperResults results = invented_results_of("white");
  results.summaries[0].curves.resize(1);  // of a figure that shows none
  results.summaries[0].series[0].values[0] = {0.12345678901, -1e-7 / 3, 12'345'678};
  results.summaries[0].series[0].values[1] = {std::nan(""), 1, 0};

  reduce_to_tables(results);

  CHECK(results.summaries[0].curves.empty());
  const std::vector<Estimate>& values = results.summaries[0].series[0].values;
  CHECK(values[0].value == 0.1234568);
  CHECK(values[0].low == -3.333333e-8);
  CHECK(values[0].high == 12'345'680);
  CHECK(std::isnan(values[1].value));
  CHECK(values[1].low == 1);
}

TEST_CASE("results are the same after a way through their folder") {
  const test::ScratchFolder folder("gust-paper-results");
  const PaperResults before = invented_results();
  write_results(before, folder.path);
  CHECK(holds_results(folder.path));
  const PaperResults after = read_results(folder.path);

  CHECK(reproduction_text(after, "x") == reproduction_text(before, "x"));
  CHECK(render_reproduction(reproduction_page(after, "x")) == render_reproduction(reproduction_page(before, "x")));
  CHECK(after.failures == before.failures);
  CHECK(after.verdicts.size() == 5);
}
