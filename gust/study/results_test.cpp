#include "gust/study/results.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/study/study_fixture.h"

using namespace gust;
using namespace gust::test;

namespace {

struct Measured {
  Study study;
  Summary summary;
};

Measured measured(Study study) {
  const ScratchFolder folder("gust-results");
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 1, .stop = {}, .watch = {}});
  Summary summary = summarise(study, outcome.plan, store, 1);
  return {std::move(study), std::move(summary)};
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
  const Measured before = measured(rich_study());
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
  const Measured found = measured(rich_study());
  const Series& ppo = *found.summary.find(2, 3, 1);
  const std::size_t metric = found.study.metrics.front();

  const std::vector<double>& values = ppo.trainings;
  REQUIRE(values.size() == 2);
  CHECK(values[0] != values[1]);
  CHECK(0.5 * (values[0] + values[1]) == doctest::Approx(ppo.at(metric, 0).value).epsilon(1e-14));
  CHECK(found.summary.find(2, 0, 1)->trainings.empty());  // several cells
  CHECK(found.summary.find(0, 3, 1)->trainings.empty());  // trained nothing
  CHECK(ppo.episode_deviation > 0);
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
  const Measured before = measured(small_study());
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
