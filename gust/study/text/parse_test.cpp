#include <doctest/doctest.h>

#include "gust/study/text/study_fixture.h"

using namespace gust;
using namespace gust::test;

namespace {

std::string error_of(const std::string& text) {
  try {
    small_study({}, text);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("a study gets every default") {
  const Study study = small_study();

  CHECK(study.name == "small");
  CHECK(study.setup.plant->plant()->spec().physics_rate == 50.0);
  CHECK(study.setup.readings.effort == "disturbed");
  REQUIRE(study.starts.size() == 2);
  CHECK(study.starts[1].random);
  CHECK(study.terminate);
  CHECK(study.metric_set.name(study.metrics.front()) == "anr_h");
  CHECK(study.sweeps[0].axes[0].values == std::vector<double>{0, 5, 30});
  CHECK(study.sweeps[1].axes[0].values == std::vector<double>{0, 1});
  CHECK(study.claims[0].start == "random");
  CHECK(study.traces.worst == 1);
}

TEST_CASE("what is wrong in a study is told with its place and what would be right") {
  struct Case {
    std::string from, to, message;
  };
  const Case cases[] = {
      {"seed = 7", "sead = 7", "small.toml:3:8: unknown key 'sead' in the study; did you mean 'seed'?"},
      {"kind = \"zero\"", "kind = \"zer\"", "small.toml:15:8: unknown policy kind 'zer'; did you mean 'zero'?"},
      {"\"step\"", "\"stp\"", "unknown waveform 'stp'; did you mean 'step'? (gust list waveforms)"},
      {"\"action\"", "\"actoin\"", "small.toml:19:8: unknown site 'actoin'; did you mean 'action'?"},
      {"[0, 5, 30]", "[]", "small.toml:21:10: 'levels' must not be empty"},
      {"[0, 5, 30]", "[0, 5, 5]", "small.toml:21:10: 'levels' must ascend, got 5 before 5"},
      {"[0, 5, 30]", "[0, nan]", "'levels' must be a finite number, got nan"},
      {"[0, 5, 30]", "[0, inf]", "'levels' must be a finite number, got inf"},
      {"[0, 5, 30]", "\"most\"", "'levels' must be a list, a range or \"auto\", got 'most'"},
      {"[0, 5, 30]", "{ from = -1.7e308, to = 1.7e308, count = 3 }",
       "small.toml:21:34: 'from' and 'to' lie too far apart, got -1.7e+308 and 1.7e+308"},
      {"[0, 5, 30]", "{ from = 0, to = 5e-324, count = 5 }", "small.toml:21:10: 'levels' must ascend, got 0 before 0"},
      {"levels = [0, 5, 30]", "levels = [0, 5, 30]\nchannels = []",
       "small.toml:22:12: disturbs nothing; choose at least one of the channels force"},
      {"levels = [0, 5, 30]", "levels = [0, 5, 30]\nchannels = {}", "small.toml:22:12: disturbs nothing; "},
      {"levels = [0, 5, 30]", "levels = [0, 5, 30]\nmask = [0]", "small.toml:22:8: disturbs nothing; "},
      {"levels = [0, 5, 30]", "levels = [0, 5, 30]\nmask = [1]\nchannels = \"all\"",
       "small.toml:22:8: 'mask' and 'channels' say the same; give one of them"},
      {"kind = \"zero\"", "kind = \"train\"\nagent = { kind = \"poo\" }",
       "small.toml:16:18: unknown agent 'poo'; did you mean 'ppo'? (gust list agents)"},
      {"offset = 2", "offset = -2", "'offset' must be >= 0, got -2"},
      {"offset = 2", "offset = 250", "'offset' must lie within the episode of 250 control steps, got 250"},
      {"offset = 2", "offset = 2.5", "'offset' must be a whole number, got 2.5"},
      {"name = \"noise\"", "name = \"push\"", "duplicate sweep name 'push'"},
      {"name = \"nothing\"", "name = \"lqr\"", "duplicate policy name 'lqr'"},
      {"episodes = 3", "episodes = 0", "'episodes' must be > 0, got 0"},
      {"episodes = 3", "episodes = 9_000_000", "small.toml:7:12: episodes must be 1 to "},
      {"episodes = 3", "episodes = \"3\"", "'episodes' must be a whole number, got text"},
      {"levels = [0, 5, 30]", "levels = [0, 5, 30]\nchannels = [\"theta\"]", "unknown channel 'theta'"},
      {"levels = [0, 5, 30]", "levels = [0, 5, 30]\nend = 251", "'end' must lie within the episode, 0 to 250, got 251"},
      {"levels = [0, 5, 30]", "levels = [0, 5, 30]\nmask = [1, 1]", "'mask' must have 1 entries"},
      {"survival <= 0.8", "survivel <= 0.8", "survivel"},
      {"schema = 1", "schema = 2", "this gust reads schema 1, got 2"},
      {"worst 1", "best 1", "'keep_traces' must read like"},
      {"to = 1, count = 2", "to = 0, count = 2", "'to' must be above 'from', got 0 and 0"},
      {"preset = \"scg-default\"", "preset = \"scg-defualt\"", "scg-default"},
  };

  for (const Case& one : cases) {
    CAPTURE(one.to);
    const std::string message = error_of(changed(one.from, one.to));
    CAPTURE(message);
    CHECK(message.find(one.message) != std::string::npos);
    CHECK(message.starts_with("small.toml:"));
  }
}

TEST_CASE("a claim about a level that its sweep lacks is told which ones there are") {
  struct Case {
    std::string where, message;
  };
  const Case cases[] = {
      {"policy = \"lqr\", sweep = \"push\", level = 4", "sweep 'push' has no level 4; it has [0, 5, 30]"},
      {"policy = \"lqr\", sweep = \"noise\", level = 0.3", "has no level 0.3; the nearest of its 101 is 0.25"},
      {"policy = \"lqr\", level = 4", "a 'level' needs its 'sweep' beside it"},
      {"policy = \"lqr\", sweep = \"push\"", "'where' needs 'level' for sweep 'push'"},
      {"policy = \"lqr\", sweep = \"pusj\", level = 5", "unknown sweep 'pusj'; did you mean 'push'?"},
  };

  for (const Case& one : cases) {
    CAPTURE(one.where);
    std::string text = changed("policy = \"nothing\"", one.where);
    text.replace(text.find("to = 1, count = 2"), 17, "to = 25, count = 101");

    const std::string message = error_of(text);

    CAPTURE(message);
    CHECK(message.find(one.message) != std::string::npos);
    CHECK(message.starts_with("small.toml:31:"));
  }
}

TEST_CASE("a claim about a sweep with automatic levels may name any from 0 on") {
  std::string text = changed("policy = \"nothing\"", "policy = \"lqr\", sweep = \"push\", level = 4");
  text.replace(text.find("[0, 5, 30]"), 10, "\"auto\"");
  CHECK(small_study({}, text).claims[0].at == std::vector<double>{4});

  text.replace(text.find("level = 4"), 9, "level = -4");
  CHECK(error_of(text).ends_with("automatic levels begin at 0, got -4"));
}

TEST_CASE("a study of more cells than anyone waits for is refused before memory is spent on it") {
  std::string text(kSmallStudy);
  for (int i = 0; i < 6; ++i) {
    text += cat("[[sweep]]\nname = \"long ", i, "\"\nsite = \"action\"\nwaveform = \"step\"\n",
                "levels = { from = 0, to = 1, count = 2_000_000 }\n");
  }

  const std::string message = error_of(text);

  CAPTURE(message);
  CHECK(message.find("with sweep 'long 4' the study has 20000010 cells") != std::string::npos);
}

TEST_CASE("settings replace what the text says, tables in a list by their name") {
  const Study study =
      small_study({"evaluate.episodes=5", "sweep.push.levels=[1, 2]", "policy.lqr.r=0.5", "plant.pole_length=0.7"});

  CHECK(study.episodes == 5);
  CHECK(study.sweeps[0].axes[0].values == std::vector<double>{1, 2});
  CHECK(study.policies[0].source->canonical({}).ends_with(" r [0.5]\n"));
  CHECK(study.setup.plant->spec().parameters[0].nominal == 0.7);
}

TEST_CASE("a setting names in quotes what holds a dot or an equals sign") {
  const std::string text = changed("\"push\"", "\"params x1.5 = a\"");

  CHECK(small_study({"sweep.\"params x1.5 = a\".levels=[1, 2]"}, text).sweeps[0].axes[0].values.back() == 2);
  CHECK(small_study({"sweep.'params x1.5 = a'.levels=[3]"}, text).sweeps[0].axes[0].values.back() == 3);
}

TEST_CASE("a setting that leads nowhere is an error with what is near") {
  const auto error_with = [](const std::string& setting) {
    try {
      small_study({setting});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };

  CHECK(error_with("sweep.psuh.levels=[1]").ends_with("the study has no 'psuh' there; did you mean 'push'?"));
  CHECK(error_with("sweep.\"push.levels=[1]").ends_with("a quote is not closed"));
  CHECK(error_with("sweep..levels=[1]").ends_with("a setting reads key=value, such as evaluate.episodes=5"));
  CHECK_THROWS_AS(small_study({"sweep.pull.levels=[1]"}), Error);
  CHECK_THROWS_AS(small_study({"evaluate.episoeds=5"}), Error);
  CHECK_THROWS_AS(small_study({"nonsense"}), Error);
}

TEST_CASE("parameters are swept by factors, by values and over a grid") {
  const std::string text = changed("[report]", R"([[sweep]]
name = "scaled"
vary = "pole_length"
scale = [0.5, 2]

[[sweep]]
name = "both"
grid = { pole_mass = [0.1, 0.2, 0.3], cart_mass = { from = 1, to = 2, count = 2 } }

[report])");

  const Study study = small_study({}, text);

  CHECK(study.sweeps[2].axes[0].values == std::vector<double>{0.25, 1.0});
  CHECK(study.sweeps[3].cells() == 6);
  CHECK(study.sweeps[3].axes[1].parameter == "cart_mass");
}
