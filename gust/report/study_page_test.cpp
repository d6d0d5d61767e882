#include "gust/report/study_page.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "gust/report/study_episodes.h"
#include "gust/study/study_fixture.h"

namespace gust {
namespace {

using test::changed;
using test::ScratchFolder;
using test::small_study;

/// The page of a study that was run in a folder of its own.
Page page_of(Study study) {
  const ScratchFolder folder("gust-study-page");
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 1, .stop = {}, .watch = {}});
  const Summary summary = summarise(study, outcome.plan, store, 1);
  return study_page(study, summary,
                    {"gust run small.toml", "small.gust", "gust export small.gust --csv small.csv", {}, {"a warning"}});
}

TEST_CASE("the page of a study has a curve for each sweep, policy, start and metric") {
  const Page page = page_of(small_study());

  CHECK(page.sweeps.size() == 2);
  CHECK(page.policies.size() == 2);
  CHECK(page.curves.size() == 2 * 2 * 2 * page.metrics.size());
  CHECK(page.metrics[0].name == "anr_h");
  CHECK(page.metrics[page.survival_metric].name == "survival");
  CHECK(page.metrics[page.saturation_metric].name == "saturation");
  CHECK(page.metrics[page.margin_metric].name == "anr_h");
  for (const Page::Curve& curve : page.curves) CHECK(curve.band.value.size() == (curve.levels.empty() ? page.sweeps[curve.sweep].levels : curve.levels).size());
  CHECK(page.margins.size() == 2 * 2 * 2);
  REQUIRE(page.claims.size() == 1);
  CHECK(page.claims[0].verdict == Page::Verdict::kHolds);
  CHECK(page.warnings == std::vector<std::string>{"a warning"});
  CHECK(page.run_command == "gust run small.toml");
  CHECK(page.sweeps[0].command == "gust eval lqr --study small.gust --sweep push --level 5 --start nominal");
}

TEST_CASE("margins of a score that the page does not lead with are still named by it") {
  const Page page = page_of(small_study({"evaluate.metrics=[\"rmse_paper\", \"survival\"]"}));

  CHECK(page.metrics[0].name == "rmse_paper");
  CHECK(page.metrics[page.margin_metric].name == "anr_h");
}

TEST_CASE("the worst cells come first and lead to the episodes that were kept of them") {
  const Page page = page_of(small_study());

  REQUIRE(page.worst.size() == 8);
  CHECK(std::ranges::is_sorted(page.worst, {}, [](const Page::WorstCell& cell) { return cell.score.value; }));
  std::size_t linked = 0;
  for (const Page::WorstCell& cell : page.worst) {
    if (cell.episode == Page::kNone) continue;
    ++linked;
    const Page::Episode& episode = page.episodes[cell.episode];
    CHECK(episode.policy == cell.policy);
    CHECK(episode.sweep == cell.sweep);
    CHECK(episode.level == cell.level);
    for (std::size_t e = 0; e < cell.episode; ++e) {
      const Page::Episode& before = page.episodes[e];  // none that fits better, and the first of a trial is the worst
      CHECK((before.policy != cell.policy || before.sweep != cell.sweep || before.level != cell.level ||
             before.start != cell.start));
    }
  }
  CHECK(linked > 0);
}

TEST_CASE("a cell whose score is no number is the worst of its sweep, one that was not measured is none") {
  const ScratchFolder folder("gust-study-page-worst");
  Study study = small_study();
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 1, .stop = {}, .watch = {}});
  Summary summary = summarise(study, outcome.plan, store, 1);
  const auto lose_scores = [&](Series& series, std::size_t from, std::size_t count) {
    const auto row = std::ranges::find(series.metrics, summary.margin_metric) - series.metrics.begin();
    const auto first = series.values.begin() + row * static_cast<std::ptrdiff_t>(series.cells);
    std::fill_n(first + static_cast<std::ptrdiff_t>(from), count,
                Estimate{std::numeric_limits<double>::quiet_NaN(), 0, 0});
  };
  for (Series& series : summary.series) {
    if (series.policy == 0 && series.sweep == 0 && series.start == 0) {
      series.not_finite = 1;
      lose_scores(series, 1, 1);
    }
    if (series.policy == 1 && series.sweep == 1 && series.start == 0) lose_scores(series, 0, series.cells);
  }

  const Page page = study_page(study, summary, {"run", "small.gust", "export", {}, {}});

  REQUIRE(page.worst.size() == 7);
  CHECK(page.worst[0].policy == 0);
  CHECK(page.worst[0].sweep == 0);
  CHECK(page.worst[0].level == 5.0);
  for (std::size_t i = 2; i < page.worst.size(); ++i) CHECK(page.worst[i - 1].score.value <= page.worst[i].score.value);
  CHECK_NOTHROW(render_page(page));
}

TEST_CASE("a kept episode is whole, and what fell says of what") {
  const Page page = page_of(small_study());

  REQUIRE(page.episodes.size() == 2 * 3 * 2);  // policies, sweeps and the nominal case, worst and median
  for (const Page::Episode& episode : page.episodes) {
    CHECK(episode.states.size() == 4);
    CHECK(episode.states[0].values.size() == episode.reward.size() + 1);
    CHECK((episode.failed_step == Page::kNone) == episode.failure.empty());
  }
  const auto fell = std::ranges::find_if(page.episodes, [](const auto& one) { return !one.failure.empty(); });
  REQUIRE(fell != page.episodes.end());
  CHECK(fell->failure.find_first_of("<>") != std::string::npos);
}

TEST_CASE("a kept episode that is none of the study's is refused") {
  const ScratchFolder folder("gust-study-page-kept");
  Study study = small_study();
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 1, .stop = {}, .watch = {}});
  const std::vector<KeptTraces> good = summarise(study, outcome.plan, store, 1).kept;
  const std::vector<std::size_t> sweep_at = {0, 1};
  REQUIRE(kept_episodes(study, good, sweep_at).size() == 2 * 3 * 2);

  const std::function<void(KeptTraces&)> changes[] = {
      [](KeptTraces& kept) { kept.member = 3; },
      [](KeptTraces& kept) { kept.traces[0].index.cell = 99'999; },
      [](KeptTraces& kept) { kept.traces[0].index.start = 7; },
      [](KeptTraces& kept) { kept.traces[0].index.episode = -1; },
      [](KeptTraces& kept) { kept.traces[0].failed_at = 1'000'000'000; },
      [](KeptTraces& kept) { kept.traces[0].reward.clear(); },
      [](KeptTraces& kept) { kept.traces[0].force = {}; },
      [](KeptTraces& kept) { kept.traces[0].observation = kept.traces[0].force; },
  };
  for (const auto& change : changes) {
    std::vector<KeptTraces> bad = good;
    change(bad[0]);
    CHECK_THROWS_WITH_AS(kept_episodes(study, bad, sweep_at), doctest::Contains("is none of this study's"), Error);
  }
}

TEST_CASE("a sweep over two parameters becomes a map") {
  const std::string text = changed("[report]", R"([[sweep]]
name = "both"
grid = { pole_mass = [0.1, 0.2, 0.3], cart_mass = [1, 2] }

[report])");

  const Page page = page_of(small_study({}, text));

  CHECK(page.sweeps.size() == 2);
  REQUIRE(page.grids.size() == 1);
  CHECK(page.grids[0].rows.name == "pole_mass");
  CHECK(page.grids[0].command == "gust eval lqr --study small.gust --sweep both --level 0.2,2 --start nominal");
  CHECK(page.grids[0].columns.name == "cart_mass");
  CHECK(page.grids[0].layers.size() == 2 * 2 * page.metrics.size());
  for (const Page::Grid::Layer& layer : page.grids[0].layers) CHECK(layer.values.size() == 6);
}

}  // namespace
}  // namespace gust
