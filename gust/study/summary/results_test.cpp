#include "gust/study/summary/results.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/member_rows.h"
#include "gust/study/trials/run.h"

using namespace gust;
using namespace gust::test;

namespace {

struct RunStudy {
  Study study;
  Summary summary;
  double deviation = 0;  ///< stored_deviation of policy 2 in sweep 3 from start 1
};

/// How far the episodes of one training of a policy lie apart in a sweep of one cell, from the rows that are stored:
/// the root of the mean square less the squared mean, mean over trainings.
double stored_deviation(const Study& study, const Plan& plan, const Store& store, std::size_t policy, std::size_t sweep,
                        std::size_t start) {
  std::vector<std::string> missing;
  double sum = 0, trainings = 0;
  for (const TrialGroup& group : trial_groups(plan)) {
    if (group.policy != policy || group.sweep != sweep) continue;
    MemberRows rows = stored_rows(study, plan, group, store, missing);
    if (!rows.next()) continue;
    const Matrix<double> values = rows.values(start, study.metric_set.name(study.metrics.front()));
    const auto n = static_cast<double>(values.lanes());
    for (std::size_t m = 0; m < values.rows(); ++m) {
      double first = 0, second = 0;
      for (const double value : values.row(m)) first += value / n, second += value * value / n;
      sum += std::sqrt((second - first * first) * n / (n - 1));
      ++trainings;
    }
  }
  return sum / trainings;
}

RunStudy measured(Study study) {
  const ScratchFolder folder("gust-results");
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 1, .stop = {}, .watch = {}});
  Summary summary = summarise(*stored_measurements(study, outcome.plan, store), 1);
  const double deviation = study.policies.size() > 2 ? stored_deviation(study, outcome.plan, store, 2, 3, 1) : 0;
  return {std::move(study), std::move(summary), deviation};
}

/// The study with an automatic sweep, a grid and two seeds of a training that is over at once.
Study rich_study() {
  std::string text = changed("levels = [0, 5, 30]", "levels = \"auto\"");
  text +=
      "[[sweep]]\nname = \"both, \\\"grid\\\"\"\ngrid = { pole_length = [0.25, 0.5], pole_mass = [0.1, 0.2, 0.3] }\n";
  text += "[[policy]]\nname = \"ppo\"\nkind = \"train\"\nagent = { kind = \"ppo\", steps = 400 }\nseeds = [3, 4]\n";
  text += "[[sweep]]\nname = \"long\"\nvary = \"pole_length\"\nscale = [1.5]\n";
  return small_study({}, text);
}

}  // namespace

TEST_CASE("a summary is the same after a way through its tables") {
  const RunStudy before = measured(rich_study());
  const std::string cells = cells_csv(before.study, before.summary);
  const std::string curves = curves_csv(before.study, before.summary);

  Study study = rich_study();
  Summary summary;
  read_cells(cells, "cells.csv", study, summary);
  read_curves(curves, "curves.csv", study, summary);

  CHECK(study.sweeps[0].axes[0].values == before.study.sweeps[0].axes[0].values);
  CHECK(summary.series.size() == before.summary.series.size());
  CHECK(summary.curves.size() == 2);
  CHECK(summary.find(2, 3, 1)->trainings == before.summary.find(2, 3, 1)->trainings);
  CHECK(summary.find(2, 3, 1)->episode_deviation == before.summary.find(2, 3, 1)->episode_deviation);
  CHECK(cells_csv(study, summary) == cells);
  CHECK(curves_csv(study, summary) == curves);
  CHECK(margins_table(study, summary, 1, 100) == margins_table(before.study, before.summary, 1, 100));
  CHECK(summary.undisturbed(0, 0) == before.summary.undisturbed(0, 0));
}

TEST_CASE("a sweep of one cell keeps what each training alone shows") {
  const RunStudy found = measured(rich_study());
  const Series& ppo = *found.summary.find(2, 3, 1);
  const std::size_t metric = found.study.metrics.front();

  const std::vector<double>& values = ppo.trainings;
  REQUIRE(values.size() == 2);
  CHECK(values[0] != values[1]);
  CHECK(0.5 * (values[0] + values[1]) == doctest::Approx(ppo.at(metric, 0).value).epsilon(1e-14));
  CHECK(found.summary.find(2, 0, 1)->trainings.empty());  // several cells
  CHECK(found.summary.find(0, 3, 1)->trainings.empty());  // trained nothing
  CHECK(found.deviation > 0);
  CHECK(ppo.episode_deviation == doctest::Approx(found.deviation).epsilon(1e-9));
  CHECK(std::isnan(found.summary.find(2, 0, 1)->episode_deviation));

  std::string cells = cells_csv(found.study, found.summary);
  const std::size_t at = cells.find("\nlqr,push,") + 1;  // a sweep of several cells
  const std::size_t comma = cells.rfind(',', cells.find('\n', at));
  cells.replace(comma + 1, cells.find('\n', at) - comma - 1, "training");
  Study study = rich_study();
  Summary summary;
  CHECK_THROWS_WITH_AS(read_cells(cells, "cells.csv", study, summary),
                       doctest::Contains("a training alone where the study keeps none"), Error);
}

TEST_CASE("tables of another study are errors with their lines") {
  const RunStudy before = measured(small_study());
  const std::string cells = cells_csv(before.study, before.summary);
  const auto read_with = [&](const std::vector<std::string>& settings) {
    Study study = small_study(settings);
    Summary summary;
    read_cells(cells, "cells.csv", study, summary);
  };

  CHECK_NOTHROW(read_with({}));
  CHECK_THROWS_WITH_AS(read_with({"policy.lqr.name=regulator"}), "cells.csv:2: the study has no policy 'lqr'", Error);
  CHECK_THROWS_WITH_AS(read_with({"sweep.push.levels=[0, 5]"}), doctest::Contains("sweep 'push' has no level of 30"),
                       Error);
  CHECK_THROWS_WITH_AS(read_with({"evaluate.start=random"}), doctest::Contains("the study has no start 'nominal'"),
                       Error);
  CHECK_THROWS_WITH_AS(read_with({"evaluate.metrics=[\"survival\"]"}),
                       doctest::Contains("the study does not lead with"), Error);
}
