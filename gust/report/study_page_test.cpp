#include "gust/report/study_page.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "gust/report/study_episodes.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/run.h"

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
  const Summary summary = summarise(*stored_measurements(study, outcome.plan, store), 1);
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
  for (const Page::Curve& curve : page.curves)
    CHECK(curve.band.value.size() == (curve.levels.empty() ? page.sweeps[curve.sweep].levels : curve.levels).size());
  CHECK(page.margins.size() == 2 * 2 * 2);
  REQUIRE(page.claims.size() == 1);
  CHECK(page.claims[0].verdict == Ruling::holds);
  CHECK(page.warnings == std::vector<std::string>{"a warning"});
  CHECK(page.run_command == "gust run small.toml");
  CHECK(page.sweeps[0].command == "gust eval lqr --study small.gust --sweep push --level 5 --start random");
}

TEST_CASE("margins of a score that the page does not lead with are still named by it") {
  const Page page = page_of(small_study({"evaluate.metrics=[\"rmse_paper\", \"survival\"]"}));

  CHECK(page.metrics[0].name == "rmse_paper");
  CHECK(page.metrics[page.margin_metric].name == "anr_h");
}

TEST_CASE("margins are told in the words of the terminal and lead to an episode that was kept of them") {
  const Page page = page_of(small_study());

  REQUIRE(page.margins.size() == 8);
  for (const Page::Margin& margin : page.margins) {
    CHECK_FALSE(margin.text.empty());
    REQUIRE(margin.episode != Page::kNone);
    const Page::Episode& episode = page.episodes[margin.episode];
    CHECK(episode.policy == margin.policy);
    CHECK(episode.sweep == margin.sweep);
  }
  CHECK_NOTHROW(render_page(page));
}

TEST_CASE("the page leads with random starts, and everything on it is of the start that it names") {
  const Page page = page_of(small_study());
  const Page other = page_of(small_study({"evaluate.start=[\"random\", \"nominal\"]"}));

  REQUIRE(page.starts.size() == 2);
  CHECK(page.starts[0].name == "random");
  CHECK(page.starts[1].name == "nominal");
  const auto value_of = [](const Page& of, std::size_t start) {
    const auto at = std::ranges::find_if(of.margins, [&](const Page::Margin& margin) {
      return margin.policy == 0 && margin.sweep == 0 && margin.start == start;
    });
    return at->text;
  };
  CHECK(value_of(page, 0) == value_of(other, 0));
  CHECK(value_of(page, 1) == value_of(other, 1));
  CHECK(value_of(page, 0) != value_of(page, 1));
  CHECK(page.sweeps[0].command.ends_with("--start random"));
  for (std::size_t e = 0; e < page.episodes.size(); ++e) CHECK(page.episodes[e].start == other.episodes[e].start);
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

TEST_CASE("a kept episode of another study is refused") {
  const ScratchFolder folder("gust-study-page-kept");
  Study study = small_study();
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 1, .stop = {}, .watch = {}});
  const std::vector<KeptTraces> good = summarise(*stored_measurements(study, outcome.plan, store), 1).kept;
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
    CHECK_THROWS_WITH_AS(kept_episodes(study, bad, sweep_at), doctest::Contains("is of another study"), Error);
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
  CHECK(page.grids[0].command == "gust eval lqr --study small.gust --sweep both --level 0.2,2 --start random");
  CHECK(page.grids[0].columns.name == "cart_mass");
  CHECK(page.grids[0].layers.size() == 2 * 2 * page.metrics.size());
  for (const Page::Grid::Layer& layer : page.grids[0].layers) CHECK(layer.values.size() == 6);
}

}  // namespace
}  // namespace gust
