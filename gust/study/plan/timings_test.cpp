#include "gust/study/plan/timings.h"

#include <doctest/doctest.h>

#include "gust/store/files.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/run.h"

using namespace gust;
using namespace gust::test;

TEST_CASE("what trials took multiplies what they are predicted to take") {
  const ScratchFolder folder("gust-timings");
  Timings first(folder.path);
  CHECK(first.factor("train ppo") == 1.0);
  first.note("train ppo", 2.0, 3.0);
  first.note("train ppo", 2.0, 5.0);
  first.save();
  Timings second(folder.path);
  CHECK(second.factor("train ppo") == 2.0);
  CHECK(second.factor("train sac") == 1.0);
  second.note("train ppo", 4.0, 1.0);
  second.save();
  CHECK(Timings(folder.path).factor("train ppo") == 9.0 / 8.0);
}

TEST_CASE("timings that cannot be read or written are no trouble") {
  const ScratchFolder folder("gust-timings-bad");
  write_file_atomically(folder.path / "timings.json", "{\"train ppo\": 3}");
  CHECK(Timings(folder.path).factor("train ppo") == 1.0);
  Timings nowhere("/proc/nowhere");
  nowhere.note("x", 1, 1);
  CHECK_NOTHROW(nowhere.save());
}

TEST_CASE("a run measures itself, and a plan predicts from it") {
  const ScratchFolder folder("gust-timings-run");
  const Store store(folder.path / "store", Store::Access::write);
  Study study = small_study();
  run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});

  const Timings timings(store.folder());
  Study other = small_study({"seed=8"});
  const Plan plan = plan_with_store(other, store);

  const double factor = timings.factor("evaluate untrained cartpole scg-default");
  CHECK(factor > 0);
  CHECK(factor != 1.0);
  for (const Trial& trial : plan.trials) {
    if (trial.kind == Trial::Kind::kEvaluate) CHECK(trial.seconds == factor * trial.guess);
  }
}
