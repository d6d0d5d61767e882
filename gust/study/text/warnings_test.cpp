#include "gust/study/text/warnings.h"

#include <doctest/doctest.h>

#include "gust/onnx/onnx.h"
#include "gust/study/text/study_fixture.h"

using namespace gust;
using namespace gust::test;

namespace {

constexpr std::string_view kMass =
    "[[sweep]]\nname = \"mass\"\nvary = \"mass\"\nscale = [0.5, 0.8, 0.95, 1, 1.05, 1.2]\n";

/// What is said of a quadrotor of this mass whose commands are clipped like this.
std::vector<std::string> warnings_of(const std::string& clip, std::string_view tables, double mass = 0.027) {
  const std::string text =
      cat("schema = 1\nname = \"q\"\nplant = { kind = \"quadrotor\", mass = ", mass,
          " }\nreadings = { command_clip = \"", clip, "\" }\n[[policy]]\nname = \"zero\"\nkind = \"zero\"\n", tables);
  return study_warnings(
      parse_study(text, "q.toml", {}, [](const std::string&, const Place&) { return std::vector<StudyFile>{}; }));
}

std::string trained_over(const std::string& mass) {
  return cat("[[policy]]\nname = \"dr\"\nkind = \"train\"\nagent = { kind = \"ppo\", randomise = { mass = ", mass,
             " } }\n");
}

using Warnings = std::vector<std::string>;

}  // namespace

TEST_CASE("masses that cannot hover are told with the numbers, by the reach of the command") {
  CHECK(warnings_of("box", kMass) ==
        Warnings{"sweep 'mass': 3 of 6 values of mass lie where no policy can hold the plant: its actions reach 0.0243 "
                 "to 0.0297 kg"});
  CHECK(warnings_of("none", kMass).empty());
}

TEST_CASE("a plant that cannot hover is told") {
  CHECK(
      warnings_of("box", "", 0.03) ==
      Warnings{"plant: mass = 0.03 kg lies where no policy can hold the plant: its actions reach 0.0243 to 0.0297 kg"});
  CHECK(warnings_of("none", "", 0.03).empty());
}

TEST_CASE("draws that reach masses that cannot hover are told, for each policy that trains with them") {
  CHECK(warnings_of("box", trained_over("{ low = 0.025, high = 0.03 }")) ==
        Warnings{"policy 'dr': randomise: some of mass, drawn from 0.025 to 0.03 kg, lie where no policy can hold the "
                 "plant: its actions reach 0.0243 to 0.0297 kg"});
  CHECK(warnings_of("box", trained_over("{ kind = \"choice\", values = [0.02, 0.025] }")).size() == 1);
  CHECK(warnings_of("box", trained_over("{ low = 0.025, high = 0.029 }")).empty());
  CHECK(warnings_of("none", trained_over("{ low = 0.025, high = 0.03 }")).empty());
}

TEST_CASE("a window that closes before the shape begins is told, of a sweep and of what is always on") {
  const std::string late = "[{ site = \"action\", waveform = { kind = \"step\", offset = 9 }, end = 9, level = 1 }]";

  CHECK(study_warnings(small_study({"sweep.push.end=3"})).empty());
  CHECK(study_warnings(small_study({"sweep.push.end=2"})) ==
        Warnings{"sweep 'push': the action step disturbs nothing: its window ends at step 2, its shape begins at step "
                 "2"});
  CHECK(study_warnings(small_study({"evaluate.disturb=" + late})) ==
        Warnings{"evaluate: the action step disturbs nothing: its window ends at step 9, its shape begins at step 9"});
}

TEST_CASE("a sweep with levels below 0 is told to have no margins") {
  CHECK(study_warnings(small_study()).empty());
  CHECK(study_warnings(small_study({"sweep.push.levels=[5, 30]", "sweep.noise.levels=[1]"})).empty());
  CHECK(study_warnings(small_study({"sweep.push.levels=[-2, 0, 2]"})) ==
        Warnings{"sweep 'push' has no margins: its levels begin at -2, below 0; sweep each side from 0 (the factors of "
                 "'channels' turn the sign)"});
  CHECK(study_warnings(
            small_study({}, changed("levels = [0, 5, 30]", "grid = { pole_length = [0.5, 1], level = [0, 3] }")))
            .empty());  // a grid has no margins
}

TEST_CASE("angles that look like degrees are told") {
  const auto told = [](const std::string& options) {
    const std::string text = cat("schema = 1\nname = \"c\"\nplant = { kind = \"cartpole\", ", options,
                                 " }\n[[policy]]\nname = \"zero\"\nkind = \"zero\"\n");
    return plant_warnings(parse_study(text, "c.toml", {}, [](const std::string&, const Place&) {
                            return std::vector<StudyFile>{};
                          }).setup);
  };

  CHECK(told("theta_limit = 12") ==
        Warnings{"plant: an episode fails beyond theta = 12 rad, more than half a turn, so that no attitude fails; are "
                 "degrees meant? 12 degrees are 0.2094 rad"});
  CHECK(told("start_range = [0, 0, 5, 0]").front() ==
        "plant: random starts spread by theta = 5 rad, more than half a turn; are degrees meant? 5 degrees are 0.08727 "
        "rad");
  CHECK(told("start = [0, 9, 0, 9]").empty());  // neither is an angle
  CHECK(told("theta_limit = 3.141592653589793").empty());
  CHECK(told("theta_limit = 3.141593").empty());  // rounded up
  CHECK(told("theta_limit = 3.15").size() == 1);
}

TEST_CASE("random starts of which some lie outside the safe set are told, and all of them are an error") {
  const auto with = [](const std::string& option) {
    return cat("schema = 1\nname = \"c\"\nplant = { kind = \"cartpole\", ", option,
               " }\n[evaluate]\nstart = \"random\"\n[[policy]]\nname = \"zero\"\nkind = \"zero\"\n");
  };

  const Study some = small_study({}, with("x_limit = 2, start_range = [2.5, 0, 0, 0]"));
  CHECK(study_warnings(some) == Warnings{"plant: random starts have x = -2.5 to 2.5, the safe set ends at -2 and 2 m: "
                                         "some episodes fail before their first step"});
  CHECK(study_warnings(small_study({}, with("x_limit = 2, start_range = [2, 0, 0, 0]"))).empty());
  CHECK_THROWS_WITH_AS(small_study({}, with("x_limit = 2, start = [5, 0, 0, 0], start_range = [2, 0, 0, 0]")),
                       "small.toml:5:9: start: random starts have x = 3 to 7, outside the safe set, -2 to 2 m", Error);
  CHECK_THROWS_WITH_AS(
      small_study({},
                  "schema = 1\nname = \"c\"\nplant = { kind = \"cartpole\", x_limit = 2, start = [5, 0, 0, 0] }\n"
                  "[[policy]]\nname = \"zero\"\nkind = \"zero\"\n"),
      "small.toml:3:9: start: x = 5 lies outside the safe set, -2 to 2 m: the episode would fail "
      "before its first step",
      Error);
}

TEST_CASE("levels of observed angles that look like degrees are told, those of mixed channels are not") {
  const auto told = [](const std::string& channels, const std::string& levels) {
    return warnings_of("none", cat("[[sweep]]\nname = \"o\"\nsite = \"observation\"\nwaveform = \"step\"\nchannels = ",
                                   channels, "\nlevels = ", levels, "\n"));
  };

  CHECK(told("[\"theta\"]", "[0, 5, 20]") ==
        Warnings{"sweep 'o': the observation step reaches 20 rad, more than half a turn; are degrees meant? 20 degrees "
                 "are 0.3491 rad"});
  CHECK(told("{ theta = -4 }", "[0, 1]").size() == 1);
  CHECK(told("[\"theta\"]", "[0, 3]").empty());
  CHECK(told("[\"theta\"]", "\"auto\"").empty());
  CHECK(told("[\"x\", \"theta\"]", "[0, 20]").empty());
}

TEST_CASE("waves with fewer than ten samples a period are told wherever they are on, and those with ten are not") {
  const auto wave = [](std::string_view site, double frequency) {
    return cat("site = \"", site, "\", waveform = { kind = \"sine\", frequency = ", frequency, " }");
  };
  const std::string tables =
      cat("[evaluate]\ndisturb = [{ ", wave("dynamics", 10), ", level = 1 }]\n",
          "[[policy]]\nname = \"ppo\"\nkind = \"train\"\nagent = { kind = \"ppo\", disturb = [{ ", wave("action", 20),
          ", level = 1 }] }\n[[sweep]]\nname = \"fast\"\nlevels = [0, 1]\nsite = \"action\"\n",
          "waveform = { kind = \"triangle\", frequency = 6 }\ndisturb = [{ ", wave("observation", 12.5),
          ", level = 1 }]\n[[sweep]]\nname = \"slow\"\nlevels = [0, 1]\nsite = \"action\"\n",
          "waveform = { kind = \"sine\", frequency = 5 }\n");

  CHECK(warnings_of("none", tables) ==
        Warnings{"evaluate: the dynamics sine of 10 Hz has 5 samples a period: its shape is coarse",
                 "policy 'ppo': the action sine of 20 Hz has 2.5 samples a period: its shape is coarse",
                 "sweep 'fast': the action triangle of 6 Hz has 8.33 samples a period: its shape is coarse",
                 "sweep 'fast': the observation sine of 12.5 Hz has 4 samples a period: its shape is coarse"});
}

TEST_CASE("byte-equal files of a pattern are one policy, and a warning names them") {
  const auto linear = [](float gain) {
    Mlp<float> mlp(MlpShape{.sizes = {4, 1}});
    mlp.weight(0, 0, 0) = gain;
    return write_onnx({mlp}, {});
  };
  const FindFiles find = [&](const std::string&, const Place&) {
    return std::vector<StudyFile>{{"a.onnx", linear(1)}, {"b.onnx", linear(2)}, {"c.onnx", linear(1)}};
  };
  const std::string text =
      "schema = 1\nname = \"s\"\nplant = { kind = \"cartpole\", preset = \"scg-default\" }\n"
      "[[policy]]\nname = \"net\"\nkind = \"onnx\"\nfile = \"*.onnx\"\n";

  const Study study = parse_study(text, "s.toml", {}, find);

  REQUIRE(study.policies[0].count() == 2);
  CHECK(study.policies[0].member(1) == "b.onnx");
  CHECK(study_warnings(study) ==
        Warnings{"policy 'net': c.onnx equals a.onnx byte for byte; the two are one policy and "
                 "count once"});
}
