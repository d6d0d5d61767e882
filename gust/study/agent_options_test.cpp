#include "gust/study/agent_options.h"

#include <doctest/doctest.h>

#include <set>

#include "gust/study/plan.h"
#include "gust/study/study_fixture.h"

using namespace gust;
using namespace gust::test;

namespace {

/// The small study with an agent to train.
Study trained(const std::string& more) {
  return small_study(
      {}, changed("kind = \"zero\"", "kind = \"train\"\nagent = { kind = \"ppo\", steps = 400" + more + " }"));
}

std::string error_of(const std::string& more) {
  try {
    trained(more);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("a named range of a preset is what it spells out") {
  const Study named = trained(", randomise = \"low\"");
  const Study spelled = trained(
      ", randomise = { cart_mass = { low = 0.7, high = 1.3 }, pole_length = { low = 0.3, high = 0.7 }, pole_mass = "
      "{ low = 0.05, high = 0.2 } }");

  const Trial a = expand(named, {}).trials.front();
  const Trial b = expand(spelled, {}).trials.front();

  CHECK(a.id == b.id);
  CHECK(a.what == "train nothing seed 1 · randomise low");
  CHECK(b.what == "train nothing seed 1 · randomise pole_length, pole_mass, cart_mass");
  CHECK(a.canonical.find("randomise pole_length = 0 + uniform(low = 0.3, high = 0.7)") != std::string::npos);
}

TEST_CASE("what is drawn in training changes the training's name") {
  std::set<std::string> ids;
  for (const char* more : {"", ", randomise = \"low\"", ", randomise = \"mid\"", ", randomise = \"high\"",
                           ", randomise = { pole_length = { low = 0.3, high = 0.7 } }",
                           ", randomise = { pole_length = { kind = \"log_uniform\", low = 0.3, high = 0.7 } }",
                           ", randomise = { mode = \"additive\", pole_length = { low = 0.3, high = 0.7 } }"}) {
    const Plan plan = expand(trained(more), {});
    CHECK(ids.insert(plan.trials.front().id).second);
  }
}

TEST_CASE("mistakes in what is drawn are told with their place") {
  CHECK(error_of(", randomise = \"hihg\"") ==
        "small.toml:16:50: unknown range 'hihg' of parameters; did you mean 'high'?; scg-default names low, mid, high "
        "for cartpole; or spell it out as a table");
  CHECK(error_of(", randomise = { pole_length = { low = 2, high = 1 } }") ==
        "small.toml:16:66: 'low' must be at most 'high', got 2 and 1");
  CHECK(error_of(", randomise = { pole_mass = { low = 0, high = 1 } }") ==
        "small.toml:16:64: 'pole_mass' must stay > 0, got a least value of 0");
  CHECK(error_of(", randomise = { pole_mas = { low = 0, high = 1 } }").find("did you mean 'pole_mass'?") !=
        std::string::npos);
  CHECK(error_of(", randomise = 3") != "no error");
}
