#include <doctest/doctest.h>

#include "gust/study/study_fixture.h"
#include "gust/study/summary.h"

using namespace gust;
using namespace gust::test;

namespace {

Series with_margin(std::size_t policy, const Margin& margin) {
  Series series{.policy = policy, .sweep = 0, .start = 0};
  series.margin = margin;
  series.has_margin = true;
  return series;
}

}  // namespace

TEST_CASE(
    "the table of margins has a row a disturbance and a column a policy, aligned, a dash where nothing is known") {
  const Study study = small_study();
  Summary summary;
  summary.series.push_back(with_margin(0, {{.estimate = 12.5, .low = 10, .high = 15}, false, 30}));
  summary.series.push_back(with_margin(1, {{.estimate = 30}, true, 30}));

  CHECK(margins_table(study, summary, 0, 80) ==
        "sweep  site      waveform  unit  lqr            nothing\n"
        "push   action    step      N     12.5 [10, 15]  ≥ 30\n"
        "noise  dynamics  white     N     -              -\n");
}

TEST_CASE("a table of margins that is too wide names the sweep alone, then goes on in blocks of policies") {
  const Study study = small_study();
  Summary summary;
  summary.series.push_back(with_margin(0, {{.estimate = 12.5, .low = 10, .high = 15}, false, 30}));
  summary.series.push_back(with_margin(1, {{.estimate = 30}, true, 30}));

  CHECK(margins_table(study, summary, 0, 55) ==
        "sweep  site      waveform  unit  lqr            nothing\n"
        "push   action    step      N     12.5 [10, 15]  ≥ 30\n"
        "noise  dynamics  white     N     -              -\n");
  CHECK(margins_table(study, summary, 0, 54) ==
        "sweep  unit  lqr            nothing\n"
        "push   N     12.5 [10, 15]  ≥ 30\n"
        "noise  N     -              -\n");
  const std::string narrow =
      "sweep  unit  lqr\n"
      "push   N     12.5 [10, 15]\n"
      "noise  N     -\n"
      "\n"
      "sweep  unit  nothing\n"
      "push   N     ≥ 30\n"
      "noise  N     -\n";
  CHECK(margins_table(study, summary, 0, 34) == narrow);
  CHECK(margins_table(study, summary, 0, 1) == narrow);
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
  summary.claims.push_back({&study.claims[0], measured, {Ruling::holds, ""}});

  CHECK(claims_table(summary) == "holds  falls  survival <= 0.8  0.5 [0.25, 0.75] (4 episodes)\n");
}
