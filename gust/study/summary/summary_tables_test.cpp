#include <doctest/doctest.h>

#include "gust/study/summary/summary.h"
#include "gust/study/text/study_fixture.h"

using namespace gust;
using namespace gust::test;

namespace {

Series with_margin(std::size_t policy, const Margin& margin) {
  Series series{.policy = policy, .sweep = 0, .start = 0};
  series.margin = margin;
  series.has_margin = true;
  return series;
}

Series with_score(std::size_t policy, double score) {
  return {.policy = policy, .cells = 1, .metrics = {MetricSet().index("anr", {})}, .values = {{score, score, score}}};
}

/// Two policies of a score each that were pushed; of the noise nothing is known.
Summary two_margins(double lqr, double nothing) {
  Summary summary{.margin_metric = MetricSet().index("anr", {})};
  summary.series = {with_score(0, lqr), with_margin(0, {{.estimate = 12.5, .low = 10, .high = 15}, false, 30}),
                    with_score(1, nothing), with_margin(1, {{.estimate = 30}, true, 30})};
  return summary;
}

}  // namespace

TEST_CASE("margins have a row a disturbance and a column a policy, and above them the score that they fall from") {
  CHECK(margins_table(small_study(), two_margins(0.9, 0.81), 0, 80) ==
        "sweep        site      waveform  unit  lqr            nothing\n"
        "undisturbed                      anr   0.9            0.81\n"
        "push         action    step      N     12.5 [10, 15]  ≥ 30\n"
        "noise        dynamics  white     N     –              –\n");
}

TEST_CASE("a policy that scores less than 90 % of the best undisturbed gets a star") {
  const std::string table = margins_table(small_study(), two_margins(0.9, 0.5), 0, 80);

  CHECK(table.find("anr   0.9            0.5 *\n") != std::string::npos);
  CHECK(table.ends_with("\n\n* below 90 % of the best: a margin from there does not compare with the others\n"));
}

TEST_CASE("a table of margins that is too wide names the sweep alone, then goes on in blocks of policies") {
  const Study study = small_study();
  const Summary summary = two_margins(0.9, 0.9);
  const std::string blocks =
      "sweep        unit  lqr\n"
      "undisturbed  anr   0.9\n"
      "push         N     12.5 [10, 15]\n"
      "noise        N     –\n"
      "\n"
      "sweep        unit  nothing\n"
      "undisturbed  anr   0.9\n"
      "push         N     ≥ 30\n"
      "noise        N     –\n";

  CHECK(margins_table(study, summary, 0, 61).starts_with("sweep        site      waveform"));
  CHECK(margins_table(study, summary, 0, 60).starts_with("sweep        unit  lqr            nothing\n"));
  CHECK(margins_table(study, summary, 0, 41).starts_with("sweep        unit  lqr            nothing\n"));
  CHECK(margins_table(study, summary, 0, 40) == blocks);
  CHECK(margins_table(study, summary, 0, 32) == blocks);
  CHECK(margins_table(study, summary, 0, 31)
            .starts_with("undisturbed, anr\n  lqr      0.9\n  nothing  0.9\npush, N\n  lqr      12.5 [10, 15]\n"));
}

TEST_CASE("why there is no margin, or the margin 0, is told once below the table") {
  Summary summary = two_margins(0.9, 0.9);
  summary.series[1] = with_margin(0, no_margin("it fails undisturbed: 0 % of the episodes last to the end"));
  summary.series.push_back(summary.series[1]);
  Margin zero{.level = {.estimate = 0, .low = 0, .high = 0}};
  zero.reason = "the wind";
  summary.series[3] = with_margin(1, zero);

  const std::string table = margins_table(small_study(), summary, 0, 80);

  CHECK(table.find("push         action    step      N     –    0 [0, 0]\n") != std::string::npos);
  CHECK(
      table.ends_with("\n\n– for lqr: it fails undisturbed: 0 % of the episodes last to the end\n"
                      "0 for nothing under push: the wind\n"));
}

TEST_CASE("a study without disturbances has no table of margins") {
  Study study = small_study();
  study.sweeps.clear();

  CHECK(margins_table(study, {}, 0, 80).empty());
}

TEST_CASE("a claim is told with its ruling, its condition and what was measured") {
  const Study study = small_study();
  Summary summary;
  const Interval measured{.estimate = 0.5, .low = 0.25, .high = 0.75, .unit = Unit::episodes, .n = 4};
  summary.claims.push_back({&study.claims[0], {.measured = measured, .verdict = {Ruling::holds, ""}}});

  CHECK(claims_table(summary, 62) == "holds  falls  survival <= 0.8  0.5 [0.25, 0.75] (4 episodes)\n");
  CHECK(claims_table(summary, 61) == "holds  falls\n       survival <= 0.8\n       0.5 [0.25, 0.75] (4 episodes)\n");
  CHECK(claims_table(summary, 27) ==
        "holds  falls\n       survival <= 0.8\n       0.5 [0.25, 0.75] (4\n       episodes)\n");
}
