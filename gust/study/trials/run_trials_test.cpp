#include "gust/study/trials/run_trials.h"

#include <doctest/doctest.h>

#include <set>

#include "gust/store/files.h"
#include "gust/study/summary/export.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/folder.h"
#include "gust/study/trials/run.h"

using namespace gust;
using namespace gust::test;

namespace {

/// The small study with a policy that is trained, kept as `gust plan --prepare` does.
StudyFolder prepared(const std::filesystem::path& path) {
  const std::string trained = "kind = \"train\"\nagent = { kind = \"ppo\", steps = 400 }\nseeds = [1]";
  write_file_atomically(path / "small.toml", changed("kind = \"zero\"", trained));
  StudyFolder folder(path / "small.gust");
  folder.keep(StudyFolder::read(path / "small.toml", {"sweep.push.levels=auto"}),
              {"small.toml", {"sweep.push.levels=auto"}});
  return folder;
}

/// The trial of an id.
PlannedTrial find(const Study& study, const Plan& plan, const std::string& id) {
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    if (plan.trials[i].id == id) return {&study, &plan, i};
  }
  throw Bug(cat("no trial ", id));
}

/// Opens folder and store anew for each job, and knows nothing of it but its id: what another process would do.
class ForgetfulExecutor : public Executor {
 public:
  explicit ForgetfulExecutor(StudyFolder folder) : folder_(std::move(folder)) {}

  std::vector<Outcome> run(std::span<const Job> jobs, std::stop_token stop, Progress& progress) override {
    std::vector<Outcome> outcomes;
    for (const Job& job : jobs) {
      ++ran[job.kind];
      progress.start(outcomes.size());
      outcomes.push_back(run_by_id(job.id, stop));
      progress.finish(outcomes.size() - 1);
    }
    return outcomes;
  }

  std::map<std::string, int> ran;  ///< jobs by kind

 private:
  Outcome run_by_id(const std::string& id, const std::stop_token& stop) const {
    Study study = folder_.open();
    const Store store(folder_.store(), Store::Access::write);
    const Plan plan = plan_with_store(study, store);
    const PlannedTrial trial = find(study, plan, id);
    return run_trials({&trial, 1}, store, {.threads = 1, .stop = stop, .watch = {}}).front();
  }

  StudyFolder folder_;
};

/// Counts what it is asked for, and does nothing.
class IdleExecutor : public Executor {
 public:
  std::vector<Outcome> run(std::span<const Job> jobs, std::stop_token, Progress&) override {
    asked.assign(jobs.begin(), jobs.end());
    return std::vector<Outcome>(jobs.size(), {Outcome::State::stopped, ""});
  }

  std::vector<Job> asked;
};

std::string exported(const StudyFolder& folder, const RunOptions& options) {
  Study study = folder.open();
  const Store store(folder.store(), Store::Access::write);
  const RunOutcome outcome = run_study(study, store, options);
  CHECK(outcome.failed() == 0);
  CHECK(outcome.plan.complete);
  export_csv(study, outcome.plan, store, folder.path() / "rows.csv");
  return read_file(folder.path() / "rows.csv");
}

}  // namespace

TEST_CASE("an executor that knows ids and the folder alone gives the bytes of one with threads") {
  const ScratchFolder one("gust-trials-one");
  const ScratchFolder two("gust-trials-two");
  ForgetfulExecutor forgetful(prepared(two.path));

  const std::string threads = exported(prepared(one.path), {.threads = 2, .stop = {}, .watch = {}});
  const std::string by_id = exported(prepared(two.path), {.stop = {}, .watch = {}, .executor = &forgetful});

  CHECK(by_id == threads);
  CHECK(forgetful.ran["train"] == 1);
  CHECK(forgetful.ran["search"] == 2);
  CHECK(forgetful.ran["evaluate"] == 6);
  CHECK(forgetful.ran["margin"] > 0);
}

TEST_CASE("jobs say what they need, and how long they take") {
  const ScratchFolder scratch("gust-trials-jobs");
  Study study = prepared(scratch.path).open();
  const Store store(scratch.path / "store", Store::Access::write);
  IdleExecutor idle;

  const RunOutcome outcome = run_study(study, store, {.stop = {}, .watch = {}, .executor = &idle});

  REQUIRE(idle.asked.size() == outcome.plan.trials.size());
  CHECK(idle.asked.front().kind == "train");
  std::set<std::string> before;
  for (const Job& job : idle.asked) {
    const PlannedTrial at = find(study, outcome.plan, job.id);
    CHECK(job.what == at.trial().what);
    CHECK(job.seconds > 0);
    std::set<std::string> needs, inputs;
    for (const std::size_t need : job.needs) needs.insert(idle.asked[need].id);
    for (const std::size_t input : at.trial().inputs) inputs.insert(outcome.plan.trials[input].id);
    CHECK(needs == inputs);
    for (const std::string& need : needs) CHECK(before.contains(need));
    before.insert(job.id);
  }
}

TEST_CASE("a trial whose input nobody makes is skipped, and the input is named with its id") {
  const ScratchFolder scratch("gust-trials-missing");
  Study study = prepared(scratch.path).open();
  const Store store(scratch.path / "store", Store::Access::write);
  const Plan plan = plan_with_store(study, store);
  std::vector<PlannedTrial> evaluations;
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    if (plan.trials[i].kind == Trial::Kind::kEvaluate && plan.trials[i].sweep == Trial::kNominal)
      evaluations.push_back({&study, &plan, i});
  }

  const std::vector<Outcome> outcomes = run_trials(evaluations, store, {.stop = {}, .watch = {}});

  REQUIRE(outcomes.size() == 2);
  CHECK(outcomes[0].state == Outcome::State::done);  // the regulator needs nothing
  CHECK(outcomes[1].state == Outcome::State::skipped);
  CHECK(outcomes[1].reason == cat("input missing: train nothing seed 1 (", plan.trials.front().id, ")"));
}

TEST_CASE("what two studies have in common is one job") {
  const ScratchFolder scratch("gust-trials-common");
  Study one = small_study();
  Study two = small_study({"sweep.push.levels=[0, 1]"});  // the other sweep and the undisturbed case are the same
  const Store store(scratch.path / "store", Store::Access::write);
  IdleExecutor idle;

  run_studies({&one, &two}, store, {.stop = {}, .watch = {}, .executor = &idle});

  std::set<std::string> ids;
  for (const Job& job : idle.asked) ids.insert(job.id);
  std::set<std::string> planned;
  for (const Study* study : {&one, &two}) {
    for (const Trial& trial : expand(*study, {}).trials) planned.insert(trial.id);
  }
  CHECK(idle.asked.size() == ids.size());
  CHECK(ids == planned);
}
