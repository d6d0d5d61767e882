#include "gust/study/trials/member_rows.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gust/study/summary/claim_scores.h"
#include "gust/study/summary/export.h"
#include "gust/study/summary/summary.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/run.h"
#include "gust/study/trials/trials.h"

using namespace gust;
using namespace gust::test;

namespace {

using Names = std::vector<std::string>;

/// Rows with these metrics alone, in this order.
std::string with_metrics(const StoredTrial& trial, const Names& metrics) {
  std::ifstream stream = trial.open(kRowsFile);
  RowsReader reader(stream, "rows");
  RowsHeader header = reader.header();
  const Names before = std::exchange(header.metrics, metrics);
  std::string bytes;
  RowsWriter writer(header, [&](std::string_view piece) { bytes.append(piece); });
  for (std::uint64_t cell = 0; cell < header.cells; ++cell) {
    const std::span<const double> all = reader.next();
    std::vector<double> kept;
    for (std::size_t first = 0; first < all.size(); first += before.size()) {
      for (const std::string& name : metrics)
        kept.push_back(all[first + static_cast<std::size_t>(std::ranges::find(before, name) - before.begin())]);
    }
    writer.append_cell(kept);
  }
  writer.finish();
  return bytes;
}

/// The small study, run by a gust whose metrics were these.
struct OlderRun {
  ScratchFolder folder;
  Study study = small_study({"evaluate.margin_tolerance=0"});
  Store now, older;
  Plan plan;
  Summary expected, summary;

  explicit OlderRun(const Names& metrics)
      : folder("gust-member-rows"),
        now(folder.path / "now", Store::Access::write),
        older(folder.path / "older", Store::Access::write),
        plan(run_study(study, now, {.threads = 1, .stop = {}, .watch = {}}).plan),
        expected(summarise(*stored_measurements(study, plan, now), 1)) {
    for (const Trial& trial : plan.trials) {
      const StoredTrial stored = *now.load(kind_name(trial.kind), trial.id);
      TrialWriter writer = older.begin(kind_name(trial.kind), trial.id);
      writer.write(kRowsFile, with_metrics(stored, metrics));
      writer.write(kTracesFile, stored.read(kTracesFile));
      writer.commit(trial.canonical);
    }
    summary = summarise(*stored_measurements(study, plan, older), 1);
  }

  std::size_t index(const std::string& metric) const { return study.metric_set.index(metric, {}); }
};

/// All metrics but some, from the last to the first.
Names reversed(const Names& without = {}) {
  const MetricSet metrics;
  Names names;
  for (const std::size_t i : metrics.stored()) {
    if (std::ranges::find(without, metrics.name(i)) == without.end()) names.push_back(metrics.name(i));
  }
  std::ranges::reverse(names);
  return names;
}

}  // namespace

TEST_CASE("rows whose metrics stand in another order are read by their names") {
  const OlderRun run(reversed({"ground_contact"}));

  REQUIRE(run.summary.series.size() == run.expected.series.size());
  for (std::size_t i = 0; i < run.summary.series.size(); ++i) {
    const Series& series = run.summary.series[i];
    const Series& expected = run.expected.series[i];
    CHECK(series.units == expected.units);
    CHECK(margin_text(series.margin) == margin_text(expected.margin));
    for (const std::size_t metric : series.metrics) {
      for (std::size_t cell = 0; cell < series.cells; ++cell)
        CHECK(series.at(metric, cell).value == expected.at(metric, cell).value);
    }
  }
  CHECK(run.summary.claims[0].finding.verdict.ruling == Ruling::holds);
}

TEST_CASE("a metric that the rows lack is not measured, and the others are") {
  const OlderRun run(reversed({"survival", "anr_h"}));

  const Series& series = *run.summary.find(0, 0, 1);
  const Series& expected = *run.expected.find(0, 0, 1);
  CHECK(std::isnan(series.at(run.index("survival"), 1).value));
  CHECK(std::isnan(series.at(run.index("anr_h"), 1).value));
  CHECK(series.at(run.index("saturation"), 1).value == expected.at(run.index("saturation"), 1).value);
  CHECK_FALSE(series.has_margin);
  CHECK(series.units == expected.units);
  CHECK(run.summary.claims[0].finding.verdict.reason == "not measured: survival of nothing");
  CHECK(run.summary.missing.empty());
}

TEST_CASE("a quotient of means is known of rows that have both of its metrics") {
  const OlderRun run(reversed({"ground_contact", "squared_state_sum"}));
  const std::vector<FormulaValue> asked = {{std::string("nothing")}, {std::string("noise")}};
  std::vector<double> returns(2), lengths(2);  // by level
  for_each_export_row(run.study, run.plan, run.older, [&](const ExportRow& row) {
    CHECK(row.metric != "anr_pooled");
    if (row.policy != "nothing" || row.sweep != "noise" || row.start != "random") return;
    if (row.metric == "return_sum") returns[row.level > 0 ? 1 : 0] += row.value;
    if (row.metric == "length") lengths[row.level > 0 ? 1 : 0] += row.value;
  });

  const auto measured = stored_measurements(run.study, run.plan, run.older);
  const ClaimScores scores({{&run.study, measured.get()}}, {"anr", "random"}, Rng(1));
  const FormulaValue curve = scores.call("anr_pooled", asked);
  for (std::size_t level = 0; level < 2; ++level) {
    CHECK(curve.as_list("a test").items[level].as_number("a test").estimate() ==
          doctest::Approx(returns[level] / lengths[level]).epsilon(1e-14));
  }
}

TEST_CASE("a quotient of means is not measured of rows that lack one of its metrics") {
  const OlderRun run(reversed({"length"}));
  const auto measured = stored_measurements(run.study, run.plan, run.older);
  const ClaimScores scores({{&run.study, measured.get()}}, {"anr", "random"}, Rng(1));
  const FormulaValue policy{std::string("nothing")};

  CHECK_THROWS_WITH_AS(scores.call("anr_pooled", {policy}), doctest::Contains("not measured: anr_pooled of nothing"),
                       NotTestable);
}

TEST_CASE("a margin of a quotient of means lies where the quotient has fallen to nine tenths") {
  ScratchFolder folder("gust-quotient-margin");
  Store store(folder.path, Store::Access::write);
  Study study = small_study({"evaluate.metrics=[\"anr_pooled\"]"});
  const Plan plan = run_study(study, store, {.threads = 1, .stop = {}, .watch = {}}).plan;
  const Summary summary = summarise(*stored_measurements(study, plan, store), 1);
  const std::size_t pooled = study.metric_set.index("anr_pooled", {});
  constexpr std::size_t kRandom = 1;

  const Series& series = *summary.find(0, 0, kRandom);  // the regulator whose actions are pushed
  const double limit = 0.9 * summary.undisturbed(0, kRandom);
  REQUIRE(summary.margin_metric == pooled);
  REQUIRE(series.margin.reason == "");
  std::size_t fallen = 0;
  while (fallen < series.added_levels.size() && series.at_added(pooled, fallen).value >= limit) ++fallen;
  REQUIRE(fallen > 0);
  REQUIRE(fallen < series.added_levels.size());
  CHECK(series.margin.level.estimate >= series.added_levels[fallen - 1]);
  CHECK(series.margin.level.estimate <= series.added_levels[fallen]);
  CHECK(series.added_levels[fallen - 1] >= 0.98 * series.added_levels[fallen]);
}

TEST_CASE("a formula that asks for a metric that the rows lack is not testable") {
  const OlderRun run(reversed({"survival"}));
  const auto measured = stored_measurements(run.study, run.plan, run.older);
  const ClaimScores scores({{&run.study, measured.get()}}, {"anr", "random"}, Rng(1));
  const FormulaValue policy{std::string("nothing")};

  const double expected = run.expected.find(1, Trial::kNominal, 1)->at(run.index("anr"), 0).value;
  CHECK(scores.call("anr", {policy}).as_number("a test").estimate() == doctest::Approx(expected).epsilon(1e-14));
  CHECK_THROWS_WITH_AS(scores.call("survival", {policy}), doctest::Contains("not measured: survival of nothing"),
                       NotTestable);
}

TEST_CASE("an export has the metrics that the rows have") {
  const OlderRun run(reversed({"survival"}));
  const auto rows_of = [&](const Store& store) {
    std::vector<std::string> rows;
    for_each_export_row(run.study, run.plan, store, [&](const ExportRow& row) {
      if (row.metric != "survival")
        rows.push_back(cat(row.policy, row.site, row.level, row.start, row.episode, row.metric, row.value));
    });
    std::ranges::sort(rows);
    return rows;
  };

  CHECK(rows_of(run.older) == rows_of(run.now));
}
