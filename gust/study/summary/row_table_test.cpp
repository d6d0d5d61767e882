#include "gust/study/summary/row_table.h"

#include <doctest/doctest.h>

#include "gust/core/csv.h"
#include "gust/core/text.h"
#include "gust/study/summary/comparison.h"
#include "gust/study/summary/export.h"
#include "gust/study/summary/summary.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/run.h"

namespace gust {
namespace {

using test::changed;
using test::ScratchFolder;
using test::small_study;

const char* const kGrid =
    "[[sweep]]\nname = \"both\"\ngrid = { pole_length = [0.4, 0.5], pole_mass = [0.1, 0.2] }\n\n[[claim]]";

/// The rows of a study that was run, as `gust export` writes them.
std::string exported(const Study& study, const Plan& plan, const Store& store) {
  std::string text = cat(kExportHead, "\n");
  for_each_export_row(study, plan, store, [&](const ExportRow& row) {
    text += csv_line({row.plant, row.preset, row.readings, row.policy, row.seed, row.sweep, row.site, row.channels,
                      row.waveform, row.window, row.vary, std::isnan(row.level_2) ? "" : cat(row.level_2),
                      cat(row.level), row.start, cat(row.episode), row.metric, cat(row.value)});
  });
  return text;
}

std::string told(const Study& study, const Summary& summary) {
  std::string text = claims_table(summary, 200);
  for (std::size_t start = 0; start < study.starts.size(); ++start) text += margins_table(study, summary, start, 200);
  for (const Series& series : summary.series) {
    for (const Estimate& estimate : series.values)
      text += cat(estimate.value, " ", estimate.low, " ", estimate.high, "\n");
    for (const double level : series.added_levels) text += cat(level, "\n");
  }
  return text;
}

/// What reading a table says, or what is wrong with it. The study has one policy, start and level besides 0.
std::string problem(const std::string& rows) {
  static constexpr const char* kStudy = R"(schema = 1
name = "rig"
plant = { kind = "cartpole", preset = "scg-default" }
policy = [{ name = "rig", kind = "zero" }]
[evaluate]
start = "nominal"
[[sweep]]
name = "push"
site = "action"
waveform = "step"
levels = [0, 1]
)";
  Study study = small_study({}, kStudy);
  try {
    read_row_table(rows, "rows.csv", study);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

constexpr const char* kHead = "policy,sweep,level,episode,metric,value\n";
constexpr const char* kNominal = "rig,none,0,0,anr_h,1\n";
constexpr const char* kPushed = "rig,push,0,0,anr_h,1\nrig,push,1,0,anr_h,0.5\n";

}  // namespace

TEST_CASE("rows that were exported say what the trials said, in whatever order they stand") {
  const ScratchFolder folder("gust-row-table");
  Study study = small_study({}, changed("[[claim]]", kGrid));
  const Store store(folder.path / "store", Store::Access::write);
  const Plan plan = run_study(study, store, {.threads = 1, .stop = {}, .watch = {}}).plan;
  const auto trials = stored_measurements(study, plan, store);
  const std::string table = exported(study, plan, store);
  std::vector<std::string> lines = split_text(table, '\n');
  std::reverse(lines.begin() + 1, lines.end());

  for (const std::string& text : {table, join(lines, "\n")}) {
    Study elsewhere = small_study({}, changed("[[claim]]", kGrid));
    const auto rows = read_row_table(text, "rows.csv", elsewhere);

    CHECK(told(elsewhere, summarise(*rows, 2)) == told(study, summarise(*trials, 1)));
    CHECK(rows->missing().empty());
    const auto found = compare_policies(*rows, {0, 1, 1}), expected = compare_policies(*trials, {0, 1, 1});
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      CHECK(found[i].found.over.interval.low == expected[i].found.over.interval.low);
      CHECK(cat(found[i].found.ratio.high) == cat(expected[i].found.ratio.high));
    }
  }
}

TEST_CASE("episodes that differ are not one, though the study would repeat them") {
  Study study = small_study({"evaluate.start=\"nominal\""});
  std::string text = "policy,sweep,level,episode,metric,value\n";
  for (const char* policy : {"lqr", "nothing"}) {
    for (const char* sweep : {"none", "push", "noise"}) {
      for (const int level : {0, 1, 5, 30}) {
        if ((level > 0 && sweep == std::string("none")) ||
            (level != 0 && level != 1 && sweep == std::string("noise")) || (level == 1 && sweep == std::string("push")))
          continue;
        for (int episode = 0; episode < 6; ++episode)
          text +=
              cat(policy, ",", sweep, ",", level, ",", episode, ",anr_h,", 1.0 - 0.01 * level - 0.001 * episode, "\n");
      }
    }
  }

  const auto rows = read_row_table(text, "rows.csv", study);
  const Summary summary = summarise(*rows, 1);

  const Series& push = *summary.find(0, 0, 0);
  CHECK(push.units == 6);
  CHECK(push.unit == Unit::episodes);
  CHECK(push.at(study.metric_set.index("anr_h", {}), 1).value == doctest::Approx(1 - 0.05 - 0.0025).epsilon(1e-12));
  CHECK(push.margin.level.estimate == doctest::Approx(0.1 * 0.9975 / 0.01).epsilon(1e-6));  // the curve is straight
}

TEST_CASE("levels beside a sweep's own refine its margin; automatic ones are those of all") {
  const std::string more = "rig,push,0.25,0,anr_h,0.95\n";
  CHECK(problem(cat(kHead, kNominal, kPushed, more)) == "");

  Study study = small_study({"sweep.push.levels=\"auto\""}, changed("levels = [0, 5, 30]", "levels = [0, 5, 30]"));
  std::string text = "policy,sweep,level,start,metric,value\n";
  for (const char* start : {"nominal", "random"}) {
    for (const char* policy : {"lqr", "nothing"}) {
      for (const double level : {0.0, 2.0, 4.0}) text += cat(policy, ",push,", level, ",", start, ",anr_h,1\n");
    }
    text += cat("lqr,push,3,", start, ",anr_h,1\n");
  }
  const auto rows = read_row_table(text, "rows.csv", study);
  CHECK(study.sweeps[0].axes[0].values == std::vector<double>{0, 2, 4});
  std::vector<double> added;
  rows->for_each_added_level(0, 0, [&](double level, const MemberRows&) { added.push_back(level); });
  CHECK(added == std::vector<double>{3});
  CHECK(rows->missing().front() == "lqr · nominal");
}

TEST_CASE("what is wrong with a table is told with its line") {
  const std::string good = cat(kHead, kNominal, kPushed);
  CHECK(problem(good) == "");
  CHECK(problem("policy,metric\nrig,anr_h\n") == "rows.csv:1: there is no column 'value'");
  CHECK(problem(kHead) == "rows.csv:1: the table has no rows");
  CHECK(problem(cat(kHead, "rigg,none,0,0,anr_h,1\n")) ==
        "rows.csv:2: the study has no policy 'rigg'; did you mean 'rig'?; it has rig");
  CHECK(problem(cat(kHead, "rig,pull,0,0,anr_h,1\n")) == "rows.csv:2: the study has no sweep 'pull'; it has push");
  CHECK(
      problem(cat(kHead, "rig,none,0,0,anr_hh,1\n")).starts_with("rows.csv:2: unknown metric 'anr_hh'; did you mean"));
  CHECK(problem(cat(kHead, "rig,push,,0,anr_h,1\n")) == "rows.csv:2: a row of sweep 'push' needs a level");
  CHECK(problem(cat(good, kNominal)) == "rows.csv:5: the row of line 2 once more");
  CHECK(problem(cat(kHead, "rig,push,1,0,anr_h,1\n")) == "rows.csv: policy 'rig', push: no rows at level 0");
  CHECK(problem(cat(good, "rig,none,0,1,survival,1\n")) ==
        "rows.csv: policy 'rig', undisturbed, level 0, start 'nominal': episode 0 has no 'survival'");
  CHECK(problem("policy,metric,value,waveform\nrig,anr_h,1,sine\n") ==
        "rows.csv:2: waveform is 'sine', where the study has 'none'");
  CHECK(problem(cat(kHead, "rig,none,0,0.5,anr_h,1\n")) == "rows.csv:2: '0.5' is no whole number (column 'episode')");
  CHECK(problem(cat(kHead, "rig,none,0,0,anr_pooled,1\n")) ==
        "rows.csv:2: 'anr_pooled' is a quotient of means; give the two that it divides");
  CHECK(problem("policy,seed,metric,value\nrig,3,anr_h,1\n") == "rows.csv:2: policy 'rig' has no seed '3'");
}

}  // namespace gust
