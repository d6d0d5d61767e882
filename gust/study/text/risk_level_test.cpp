#include <doctest/doctest.h>

#include <set>

#include "gust/agents/agent_fixture_test.h"
#include "gust/onnx/onnx.h"
#include "gust/study/plan/plan.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/run.h"
#include "gust/study/trials/trials.h"

using namespace gust;
using namespace gust::test;

namespace {

std::string policy(const std::string& name, const std::string& agent, const std::string& level) {
  return cat("[[policy]]\nname = \"", name, "\"\nkind = \"train\"\nagent = { ", agent, " }\nalpha = ", level, "\n\n");
}

constexpr const char* kSmallAgent = "kind = \"wcpg\", profile = \"wcpg-fixed\", steps = 1_200, hidden = 16";

/// kSmallStudy with these policies before its own.
Study study_with(const std::string& policies) {
  std::string text(kSmallStudy);
  text.insert(text.find("[[policy]]"), policies);
  return small_study({}, text);
}

}  // namespace

TEST_CASE("policies that differ in their risk level only share a training, and are evaluated each by itself") {
  Study study = study_with(policy("careful", kSmallAgent, "0.1") + policy("bold", kSmallAgent, "1"));
  const ScratchFolder folder("gust-risk-level");
  const Store store(folder.path / "store", Store::Access::write);

  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});

  const Plan& plan = outcome.plan;
  CHECK(outcome.failed() == 0);
  REQUIRE(plan.trials.size() == 2 + 4 * 3 + 4 * 2);
  CHECK(plan.trials[0].id == plan.trials[1].id);
  std::set<std::string> evaluations;
  for (const Trial& trial : plan.trials) {
    if (trial.kind == Trial::Kind::kEvaluate) evaluations.insert(trial.id);
  }
  CHECK(evaluations.size() == 4 * 3);
  std::set<std::string> rows;
  for (const std::size_t trial : {2u, 5u}) rows.insert(store.load("evaluate", plan.trials[trial].id)->read(kRowsFile));
  CHECK(rows.size() == 2);  // they act differently
}

TEST_CASE("a risk level that a policy cannot act at is an error that says what would be right") {
  const auto parsing = [](const std::string& agent, const std::string& level) {
    return [=] { study_with(policy("p", agent, level)); };
  };
  CHECK_THROWS_WITH_AS(parsing("kind = \"ppo\"", "0.3")(), doctest::Contains("ppo does not"), Error);
  CHECK_THROWS_WITH_AS(parsing("kind = \"raac\"", "0.3")(), doctest::Contains("raac does not"), Error);
  CHECK_THROWS_WITH_AS(parsing("kind = \"wcpg\", alpha_min = 0.2", "0.1")(),
                       doctest::Contains("must be a level that the agent trains, 0.2 to 1, got 0.1"), Error);
  CHECK_THROWS_AS(parsing("kind = \"wcpg\"", "0")(), Error);
  CHECK_THROWS_AS(parsing("kind = \"wcpg\"", "1.5")(), Error);
  CHECK_THROWS_AS(parsing("kind = \"wcpg\"", "\"low\"")(), Error);
}

TEST_CASE("a policy of WCPG acts at its level unless it is told another, in its file too") {
  const auto plant = cartpole();
  const auto agent = agents().make(
      {{{"kind", text("wcpg")}, {"hidden", integer(32)}, {"steps", integer(1'200)}, {"alpha", number(0.25)}},
       {"test"}});
  const auto training = agent->start({plant.object.get(), {}, {}, 1});
  while (!training->done()) training->advance();
  const ActorNetwork actor = training->actor();
  const std::string bytes = write_onnx(actor, {});
  const std::vector<float> seen = {0.1f, -0.2f, 0.05f, 0.3f};
  const auto act = [&](const OnnxModel& model) {
    std::vector<float> action(1);
    OnnxRunner(model).run(seen, 1, action);
    return action[0];
  };

  const float own = act(read_onnx(bytes, "p.onnx"));

  CHECK(own == act(read_onnx(bytes, "p.onnx", {.alpha = 0.25f})));
  CHECK(own != act(read_onnx(bytes, "p.onnx", {.alpha = 0.75f})));
  CHECK(own == ActorRunner(actor, 1).act(seen)[0]);
}
