#include "gust/study/plan/plan.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "gust/onnx/onnx.h"
#include "gust/study/text/study_fixture.h"

using namespace gust;
using namespace gust::test;

TEST_CASE("a plan has one trial for each policy and sweep, and one undisturbed") {
  const Plan plan = expand(small_study(), {});

  CHECK(plan.complete);
  REQUIRE(plan.trials.size() == 6 + 4);
  CHECK(plan.trials[0].what == "evaluate lqr · nominal");
  CHECK(plan.trials[1].what == "evaluate lqr · push");
  std::set<std::string> ids;
  for (const Trial& trial : plan.trials) ids.insert(trial.id);
  CHECK(ids.size() == plan.trials.size());
}

TEST_CASE("a trial's name follows from what it does, not from what it is called") {
  const Plan plan = expand(small_study(), {});
  const Plan renamed = expand(small_study({"sweep.push.name=pull", "policy.lqr.name=regulator"}), {});

  for (std::size_t i = 0; i < plan.trials.size(); ++i) CHECK(plan.trials[i].id == renamed.trials[i].id);
}

TEST_CASE("whatever changes an outcome changes the trial's name") {
  const std::string before = expand(small_study(), {}).trials[1].id;

  for (const char* setting :
       {"seed=8", "evaluate.episodes=4", "sweep.push.levels=[0, 5]", "policy.lqr.r=0.5", "plant.pole_mass=0.2",
        "sweep.push.waveform.offset=3", "evaluate.terminate=false", "sweep.push.end=100", "evaluate.start=nominal"}) {
    CAPTURE(setting);
    CHECK(expand(small_study({setting}), {}).trials[1].id != before);
  }
  CHECK(expand(small_study({"question=why"}), {}).trials[1].id == before);
}

TEST_CASE("a margin has a trial of its own, which follows from the scores that it is measured from") {
  const Plan plan = expand(small_study(), {});
  const Trial& margin = plan.trials[6];

  CHECK(margin.kind == Trial::Kind::kMargin);
  CHECK(margin.what == "margin lqr · push");
  CHECK(margin.inputs == std::vector<std::size_t>{0, 1});
  CHECK(expand(small_study({"sweep.push.name=pull"}), {}).trials[6].id == margin.id);
  for (const char* setting : {"seed=8", "evaluate.episodes=4", "sweep.push.levels=[0, 5]", "policy.lqr.r=0.5",
                              "evaluate.margin_tolerance=0.05", "evaluate.metrics=[\"anr\"]"}) {
    CAPTURE(setting);
    CHECK(expand(small_study({setting}), {}).trials[6].id != margin.id);
  }
  CHECK(expand(small_study({"evaluate.margin_tolerance=0"}), {}).trials.size() == 6);
  CHECK(expand(small_study({"sweep.push.levels=[-2, 0, 2]"}), {}).trials.size() == 6 + 2);
}

TEST_CASE("the margins of a policy are those of the seeds whose training did not fail") {
  const Study study = small_study({}, changed("[[sweep]]\nname = \"push\"", R"([[policy]]
name = "ppo"
kind = "train"
agent = { kind = "ppo", steps = 400 }
seeds = [1, 2]

[[sweep]]
name = "push")"));
  const Plan whole = expand(study, {});
  const Plan rest = expand(study, {}, {whole.trials[0].id});
  const auto margin_of = [](const Plan& plan) {
    return *std::ranges::find(plan.trials, "margin ppo · push", &Trial::what);
  };

  CHECK(margin_of(whole).inputs.size() == 4);
  CHECK(margin_of(rest).inputs.size() == 2);
  CHECK(margin_of(rest).id != margin_of(whole).id);
}

TEST_CASE("an automatic sweep waits for its levels") {
  Study study = small_study({"sweep.push.levels=auto"});

  const Plan searching = expand(study, {});
  CHECK_FALSE(searching.complete);
  CHECK(searching.trials.front().kind == Trial::Kind::kSearch);

  const FoundLevels found = {{0, {0, 1, 2}}};
  set_levels(study, found);
  const Plan found_plan = expand(study, found);
  CHECK(found_plan.complete);
  CHECK(found_plan.trials.size() == 8 + 4);
}

TEST_CASE("the common levels reach half beyond the greatest failure level") {
  const std::vector<double> levels = common_levels({2.0, 4.0, INFINITY}, 60.0);

  REQUIRE(levels.size() == 11);
  CHECK(levels.front() == 0.0);
  CHECK(levels.back() == 6.0);
  CHECK(common_levels({INFINITY}, 60.0).back() == 60.0);
}

namespace {

/// The name of a training under some settings.
std::string training_under(std::string_view agent, const std::vector<std::string>& settings) {
  const std::string text = cat("schema = 1\nname = \"t\"\nplant = { kind = \"cartpole\", preset = \"scg-2022\" }\n",
                               "[[policy]]\nname = \"p\"\nkind = \"train\"\nagent = ", agent, "\n");
  return expand(small_study(settings, text), {}).trials.front().id;
}

}  // namespace

TEST_CASE("an undisturbed training is shared by readings that it cannot tell apart") {
  constexpr std::string_view kPpo = "{ kind = \"ppo\", steps = 400 }";
  const std::string before = training_under(kPpo, {});
  CHECK(training_under(kPpo, {"readings.saturate=before"}) == before);
  CHECK(training_under(kPpo, {"readings.tap_point=tip"}) == before);
  CHECK(training_under(kPpo, {"readings.effort=applied"}) != before);
  CHECK(training_under(kPpo, {"readings.effort=disturbed", "readings.saturate=before"}) !=
        training_under(kPpo, {"readings.effort=disturbed"}));

  for (const std::string_view agent :
       {"{ kind = \"rap\", steps = 400 }", "{ kind = \"rarl\", steps = 400 }",
        "{ kind = \"ppo\", steps = 400, disturb = [{ site = \"action\", waveform = \"white\", level = 1 }] }"}) {
    CAPTURE(agent);
    CHECK(training_under(agent, {"readings.saturate=before"}) != training_under(agent, {}));
    CHECK(training_under(agent, {"readings.tap_point=tip"}) != training_under(agent, {}));
  }
}

namespace {

/// The small study with one foreign policy: a gain of four numbers.
Study foreign_study(const std::vector<std::string>& settings) {
  Mlp<float> mlp(MlpShape{.sizes = {4, 1}});
  const std::string bytes = write_onnx({mlp}, {});
  const auto find = [&](const std::string& pattern, const Place&) { return std::vector<StudyFile>{{pattern, bytes}}; };
  const std::string text =
      changed("name = \"nothing\"\nkind = \"zero\"", "name = \"nothing\"\nkind = \"onnx\"\nfile = \"a.onnx\"");
  return parse_study(text, "small.toml", settings, find);
}

std::string foreign_trial(const std::vector<std::string>& settings) {
  return expand(foreign_study(settings), {}).trials[4].canonical;
}

}  // namespace

TEST_CASE("how a foreign policy sees and acts is part of its trials' text, where it differs from gust's own way") {
  const std::string before = foreign_trial({});

  CHECK(before.find("observe") == std::string::npos);
  CHECK(foreign_trial({"policy.nothing.units=\"N\""}) == before);
  CHECK(foreign_trial({"policy.nothing.observe=[\"x\", \"x_dot\", \"theta\", \"theta_dot\"]"}) == before);
  CHECK(foreign_trial({"policy.nothing.units=\"mN\""}).find("\nact 0.001 0\n") != std::string::npos);
  CHECK(foreign_trial({"policy.nothing.observe=[\"theta\", \"-x\", { x_dot = \"cm/s\" }, \"cos theta\"]"})
            .find("\nobserve theta 1 0, x -1 0, x_dot 100 0, cos theta 1 0\n") != std::string::npos);
}
