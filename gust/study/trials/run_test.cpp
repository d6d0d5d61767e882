#include "gust/study/trials/run.h"

#include <doctest/doctest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "gust/store/files.h"
#include "gust/study/summary/export.h"
#include "gust/study/summary/summary.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/folder.h"
#include "gust/study/trials/trials.h"

using namespace gust;
using namespace gust::test;

namespace {

std::string run_and_export(const std::filesystem::path& folder, std::size_t threads,
                           const std::vector<std::string>& settings = {}) {
  Study study = small_study(settings);
  const Store store(folder / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = threads, .stop = {}, .watch = {}});
  REQUIRE(outcome.failed() == 0);
  export_csv(study, outcome.plan, store, folder / "rows.csv");
  return read_file(folder / "rows.csv");
}

}  // namespace

TEST_CASE("a study gives the same table on one thread and on three, and finds all of it again") {
  const ScratchFolder one("gust-run-one");
  const ScratchFolder three("gust-run-three");

  const std::string first = run_and_export(one.path, 1);

  CHECK(first == run_and_export(three.path, 3));
  Study study = small_study();
  const Store store(one.path / "store", Store::Access::write);
  bool anything = false;  // is left to be run
  run_study(study, store, {.threads = 1, .stop = {}, .watch = [&](Progress&, const auto& work) {
                             anything = true;
                             work();
                           }});
  CHECK_FALSE(anything);
}

TEST_CASE("the exported table has a row for each episode and metric") {
  const ScratchFolder folder("gust-run-rows");

  const std::string csv = run_and_export(folder.path, 2, {"evaluate.margin_tolerance=0"});

  const auto lines = static_cast<std::size_t>(std::ranges::count(csv, '\n'));
  const std::size_t cells = 2 * (1 + 3 + 2);  // policies x (nominal, push, noise)
  CHECK(lines == 1 + cells * 2 * 3 * MetricSet().stored().size());
  CHECK(csv.starts_with(std::string(kExportHead)));
}

TEST_CASE("an export replaces a file, never a folder or a device") {
  const ScratchFolder folder("gust-run-export");
  run_and_export(folder.path, 1);
  Study study = small_study();
  const Store store(folder.path / "store", Store::Access::read);
  const Plan plan = plan_with_store(study, store);
  const std::filesystem::path pipe = folder.path / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);

  CHECK_THROWS_WITH_AS(export_sqlite(study, plan, store, pipe), doctest::Contains("pipe: is no regular file"), Error);
  CHECK_THROWS_WITH_AS(export_csv(study, plan, store, folder.path), doctest::Contains("Is a directory"), Error);

  CHECK(std::filesystem::is_fifo(pipe));
  CHECK(std::filesystem::is_regular_file(folder.path / "rows.csv"));
  CHECK_FALSE(std::filesystem::exists(folder.path / "pipe.part"));
}

TEST_CASE("a summary agrees with the rows it came from") {
  const ScratchFolder folder("gust-run-summary");
  Study study = small_study();
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});

  const Summary summary = summarise(*stored_measurements(study, outcome.plan, store), 2);

  double sum = 0;
  std::size_t count = 0;
  for_each_export_row(study, outcome.plan, store, [&](const ExportRow& row) {
    if (row.policy == "lqr" && row.site == "dynamics" && row.level == 1 && row.start == "random" &&
        row.metric == "anr") {
      sum += row.value;
      ++count;
    }
  });
  const Series* series = summary.find(0, 1, 1);
  REQUIRE(series != nullptr);
  CHECK(count == 3);
  CHECK(series->at(study.metric_set.index("anr", {}), 1).value == doctest::Approx(sum / 3).epsilon(1e-14));
  CHECK(series->has_margin);
  CHECK(series->unit == Unit::episodes);
  REQUIRE(summary.claims.size() == 1);
  CHECK(summary.claims[0].finding.verdict.ruling == Ruling::holds);  // none of three: at most 0.56
}

TEST_CASE("the regulator tolerates a push of half the actuator and the bare plant falls") {
  const ScratchFolder folder("gust-run-physics");
  Study study = small_study();
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});

  const Summary summary = summarise(*stored_measurements(study, outcome.plan, store), 1);

  const std::size_t survival = study.metric_set.index("survival", {});
  CHECK(summary.find(0, 0, 1)->at(survival, 1).value == 1.0);
  CHECK(summary.find(1, Trial::kNominal, 1)->at(survival, 0).value == 0.0);
}

TEST_CASE("automatic levels are found and used in one run") {
  const ScratchFolder folder("gust-run-auto");
  Study study = small_study({"sweep.push.levels=auto"});
  const Store store(folder.path / "store", Store::Access::write);

  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});

  CHECK(outcome.plan.complete);
  CHECK(study.sweeps[0].axes[0].values.size() == 11);
}

TEST_CASE("automatic levels hold those that claims are about") {
  const ScratchFolder folder("gust-run-claimed");
  const std::string claim = "policy = \"lqr\", sweep = \"push\", level = 3.25";
  Study study = small_study({"sweep.push.levels=auto"}, changed("policy = \"nothing\"", claim));
  const Store store(folder.path / "store", Store::Access::write);

  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});
  const Summary summary = summarise(*stored_measurements(study, outcome.plan, store), 1);

  const std::vector<double>& levels = study.sweeps[0].axes[0].values;
  CHECK(levels.size() == 12);
  CHECK(std::ranges::is_sorted(levels));
  REQUIRE(summary.claims.size() == 1);
  CHECK(summary.claims[0].finding.measured.estimate == 1.0);
}

TEST_CASE("a claim whose trial is missing is told, and not decided") {
  const ScratchFolder folder("gust-run-unmeasured");
  Study study = small_study();
  const Store store(folder.path / "store", Store::Access::write);

  const Summary summary = summarise(*stored_measurements(study, plan_with_store(study, store), store), 1);

  CHECK(claims_table(summary, 80) ==
        "not testable  falls  survival <= 0.8  not measured: evaluate nothing · nominal\n");
}

TEST_CASE("kept episodes and curves are read back as they were written") {
  const ScratchFolder folder("gust-run-traces");
  Study study = small_study();
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 1, .stop = {}, .watch = {}});
  const Trial& trial = outcome.plan.trials[1];

  const std::string text = store.load("evaluate", trial.id)->read(kTracesFile);
  const std::vector<Trace> traces = read_traces(text, "traces");

  REQUIRE(traces.size() == 2);
  CHECK(traces_text(traces) == text);
  CHECK(traces[0].state.lanes() == 251);
  const std::vector<CurvePoint> curve = {{0, 1.5, 0.25, 30, 0.5, 0.125, 0.75},
                                         {800, 1.5, 0.25, 30, 0.5, 0.125, 0.75, 400}};
  CHECK(curve_text(read_curve(curve_text(curve), "curve")) == curve_text(curve));
  CHECK(read_curve("steps,return_mean,return_std,length_mean,anr,anr_h,rmse_scg\n400,1,0,30,0.5,0.125,0.75\n", "old")
            .front()
            .protagonist_steps == 400);
  CHECK_THROWS_AS(read_curve("nonsense", "curve"), Error);
  CHECK_THROWS_AS(read_traces("[{}]", "traces"), Error);
}

TEST_CASE("a study's folder gives the study back without the file it came from") {
  const ScratchFolder folder("gust-run-folder");
  const StudyFolder kept(folder.path);
  kept.keep(small_study({"evaluate.episodes=4"}), {"small.toml", {"evaluate.episodes=4"}});

  const Study study = kept.open();

  CHECK(study.text == kSmallStudy);
  CHECK(study.episodes == 4);
  CHECK(kept.inputs().settings == std::vector<std::string>{"evaluate.episodes=4"});
  CHECK_THROWS_AS(StudyFolder(folder.path / "nowhere").open(), Error);
}

TEST_CASE("a folder with other things in it is left alone") {
  const ScratchFolder folder("gust-run-foreign");
  std::filesystem::create_directories(folder.path);
  std::ofstream(folder.path / "thesis.tex") << "x";

  CHECK_THROWS_AS(StudyFolder(folder.path).keep(small_study(), {}), Error);
}

TEST_CASE("readings that share a training give it the same bits") {
  const auto trained = [](const std::vector<std::string>& settings) {
    const ScratchFolder folder("gust-run-readings");
    const Store store(folder.path / "store", Store::Access::write);
    Study study = small_study(settings, R"(schema = 1
name = "t"
plant = { kind = "cartpole", preset = "scg-2022" }
policy = [{ name = "ppo", kind = "train", agent = { kind = "ppo", steps = 2000 } },
          { name = "sac", kind = "train", agent = { kind = "sac", steps = 1200, hidden = 16 } }]
)");
    const Plan plan = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}}).plan;
    return store.load("train", plan.trials[0].id)->read(kPolicyFile) +
           store.load("train", plan.trials[1].id)->read(kPolicyFile);
  };
  const std::string before = trained({});
  CHECK(trained({"readings.saturate=before"}) == before);
  CHECK(trained({"readings.tap_point=tip"}) == before);
}

namespace {

/// Sweeps of every kind, many of them alike in all but one thing.
constexpr std::string_view kManySweeps = R"(
[[sweep]]
name = "step on fx"
site = "dynamics"
channels = "fx"
waveform = { kind = "step", offset = 2 }
levels = [0, 1]

[[sweep]]
name = "step on fz, half as strong"
site = "dynamics"
channels = { fz = 0.5 }
waveform = { kind = "step", offset = 2 }
levels = [0, 1]

[[sweep]]
name = "step, late"
site = "dynamics"
channels = "fx"
waveform = { kind = "step", offset = 2 }
start = 50
end = 200
levels = [0, 1]

[[sweep]]
name = "step in wind"
site = "dynamics"
channels = "fx"
waveform = { kind = "step", offset = 2 }
disturb = [{ site = "dynamics", waveform = "white", level = 0.5 }]
levels = [0, 1]

[[sweep]]
name = "step, stronger wind"
site = "dynamics"
channels = "fx"
waveform = { kind = "step", offset = 2 }
disturb = [{ site = "dynamics", waveform = { kind = "white", std = 2 }, level = 0.5 }]
levels = [0, 1]

[[sweep]]
name = "step, long pole"
site = "dynamics"
channels = "fx"
waveform = { kind = "step", offset = 2 }
params = { pole_length = "x1.5" }
levels = [0, 1]

[[sweep]]
name = "length"
vary = "pole_length"
scale = [0.5, 1]

[[sweep]]
name = "length in wind"
vary = "pole_length"
scale = [0.5, 1]
disturb = [{ site = "dynamics", waveform = "white", level = 0.5 }]

[[sweep]]
name = "length and mass"
grid = { pole_length = [0.4, 0.6], cart_mass = [0.8, 1.2] }

[[sweep]]
name = "length and level"
site = "action"
waveform = "white"
grid = { pole_length = [0.4, 0.6], level = [0, 2] }
)";

/// What is counted by a statement on an SQLite file.
std::int64_t counted(const std::filesystem::path& file, const char* sql) {
  sqlite3* database = nullptr;
  sqlite3_stmt* statement = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &database) == SQLITE_OK);
  REQUIRE(sqlite3_prepare_v2(database, sql, -1, &statement, nullptr) == SQLITE_OK);
  REQUIRE(sqlite3_step(statement) == SQLITE_ROW);
  const std::int64_t count = sqlite3_column_int64(statement, 0);
  sqlite3_finalize(statement);
  sqlite3_close(database);
  return count;
}

}  // namespace

TEST_CASE("no two exported rows agree in all but the value, whatever kinds of sweeps a study has") {
  const ScratchFolder folder("gust-run-keys");
  Study study = small_study({}, cat(kSmallStudy, kManySweeps));
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});
  REQUIRE(outcome.failed() == 0);
  std::size_t added = 0;
  for (const Series& series : summarise(*stored_measurements(study, outcome.plan, store), 1).series)
    added += series.added_levels.size();

  export_csv(study, outcome.plan, store, folder.path / "rows.csv");
  export_sqlite(study, outcome.plan, store, folder.path / "rows.db");

  const std::string csv = read_file(folder.path / "rows.csv");
  std::set<std::string_view> keys;
  std::size_t rows = 0;
  for (std::string_view rest = csv; !rest.empty(); ++rows) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    keys.insert(line.substr(0, line.rfind(',')));
    rest.remove_prefix(line.size() + 1);
  }
  const std::size_t cells = 2 * (1 + 3 + 2 + 6 * 2 + 2 * 2 + 2 * 4);
  CHECK(added > 20);
  CHECK(rows == 1 + (cells * 2 + added) * 3 * MetricSet().stored().size());  // two starts, three episodes
  CHECK(keys.size() == rows);
  CHECK(counted(folder.path / "rows.db", "select count(*) from episodes") == static_cast<std::int64_t>(rows) - 1);
  CHECK(counted(folder.path / "rows.db",
                "select count(*) from (select distinct plant, preset, readings, policy, seed, sweep, site, channels, "
                "waveform, window, vary, level_2, level, start, episode, metric from episodes)") ==
        static_cast<std::int64_t>(rows) - 1);
}

TEST_CASE("an exported row says which sweep it belongs to, and its levels are numbers") {
  const ScratchFolder folder("gust-run-columns");
  Study study = small_study({}, cat(kSmallStudy, kManySweeps));
  const Store store(folder.path / "store", Store::Access::write);
  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});
  std::map<std::string, ExportRow> last;

  for_each_export_row(study, outcome.plan, store, [&](const ExportRow& row) { last[row.sweep] = row; });
  export_sqlite(study, outcome.plan, store, folder.path / "rows.db");

  const ExportRow& late = last.at("step, late");
  CHECK(cat(late.site, "|", late.channels, "|", late.window, "|", late.vary) == "dynamics|fx|50:200|");
  CHECK(std::isnan(late.level_2));
  CHECK(last.at("step on fz, half as strong").channels == "fz=0.5");
  CHECK(last.at("push").window == "0:250");
  const ExportRow& grid = last.at("length and level");
  CHECK(cat(grid.vary, "|", grid.level, "|", grid.level_2) == "pole_length*level|0.6|2");
  CHECK(last.at("length and mass").site == "parameters");
  CHECK(last.at("none").level == 0);
  CHECK(counted(folder.path / "rows.db", "select count(*) from episodes where level = 0.6 and level_2 = 2") > 0);
  CHECK(counted(folder.path / "rows.db", "select count(*) from episodes where sweep = 'step, late' and level = 1") > 0);
  CHECK(counted(folder.path / "rows.db", "select count(*) from episodes where typeof(level) <> 'real'") == 0);
}
