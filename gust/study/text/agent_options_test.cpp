#include "gust/study/text/agent_options.h"

#include <doctest/doctest.h>

#include <set>

#include "gust/agents/agent.h"
#include "gust/setup/presets.h"
#include "gust/study/plan/plan.h"
#include "gust/study/text/study_fixture.h"

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

TEST_CASE("every profile of an agent says all of its options") {
  for (const Entry<Agent>& entry : agents().entries()) {
    for (const Preset& preset : presets()) {
      if (!has_agent_profile(preset, entry.name, "cartpole")) continue;
      CAPTURE(preset.name);
      const Table options = agent_profile(entry.name, "cartpole", preset.name);

      CHECK_NOTHROW(entry.make(options));
      for (const FieldInfo& field : entry.fields) CHECK(options.contains(field.name));
    }
  }
}

TEST_CASE("the profile scg-2022 of an agent is what it does by itself, but for its actor's trunk, and modern is not") {
  for (const char* name : {"ppo", "sac", "wcpg", "raac"}) {
    const Entry<Agent>& agent = agents().at(name);
    Table options;
    if (std::string_view(name) != "ppo") {
      options.set("actor_trunk", {std::string("scg"), {}});
      options.set("density", {std::string("tanh"), {}});
    }
    const std::string standard = agent.make(options).canonical();

    CHECK(agent.make(agent_profile(name, "cartpole", "scg-2022")).canonical() == standard);
    CHECK(agent.make(agent_profile(name, "cartpole", "scg-default")).canonical() == standard);
  }
  const Entry<Agent>& ppo = agents().at("ppo");
  const std::string standard = ppo.make(Table{}).canonical();
  CHECK(ppo.make(agent_profile("ppo", "cartpole", "modern")).canonical() != standard);
}

TEST_CASE("a memory that the machine cannot hold is an error with the bytes") {
  Table plant;
  plant.set("kind", {std::string("cartpole"), {}});
  const Setup setup = make_setup(plant);
  Table agent{{}, {"s.toml", 2, 1}};
  agent.set("kind", {std::string("sac"), {}});
  CHECK(make_agent(agent, setup)->memory(setup.plant->plant()->spec()) == 44'000'000);
  agent.set("buffer", {std::int64_t{1'000'000'000'000}, {}});
  agent.set("steps", {std::int64_t{1'000'000'000'000}, {}});

  CHECK_THROWS_AS(make_agent(agent, setup), Error);
  CHECK_THROWS_WITH_AS(check_memory(44'000, 43'999, {"s.toml", 2, 1}),
                       "s.toml:2:1: the agent's 'buffer' would take 44000 bytes of memory when it is full, and the "
                       "machine has 43999; use a smaller one",
                       Error);
}

TEST_CASE("a profile that is not there is an error with the nearest name, and is no preset of a plant") {
  CHECK_THROWS_WITH_AS(agent_profile("ppo", "cartpole", "moderm", {"s.toml", 3, 4}),
                       "s.toml:3:4: unknown profile 'moderm'; did you mean 'modern'?; the profiles of ppo are "
                       "scg-2022, scg-default, modern",
                       Error);
  CHECK_THROWS_AS(preset_at("modern", "cartpole"), Error);
}
