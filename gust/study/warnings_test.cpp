#include "gust/study/warnings.h"

#include <doctest/doctest.h>

#include "gust/nn/onnx.h"
#include "gust/study/study_fixture.h"

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
  return study_warnings(parse_study(text, "q.toml", {},
                                    [](const std::string&, const Place&) { return std::vector<StudyPolicy::File>{}; }));
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

TEST_CASE("a sweep that does not begin undisturbed and a start that has failed already are told") {
  CHECK(study_warnings(small_study()).empty());
  CHECK(study_warnings(small_study({"sweep.push.levels=[5, 30]", "sweep.noise.levels=[1]"})) ==
        Warnings{"sweep 'push' begins at level 5: its margins are falls from the score there, not from the undisturbed "
                 "one"});
  CHECK(study_warnings(
            small_study({}, changed("levels = [0, 5, 30]", "grid = { pole_length = [0.5, 1], level = [0, 3] }")))
            .empty());  // a grid has no margins
  CHECK(study_warnings(small_study({"evaluate.start={ x = 3.0 }"})) ==
        Warnings{"start 'x=3' lies beyond the bounds at which an episode fails"});
}

TEST_CASE("byte-equal files of a pattern are one policy, and a warning names them") {
  const auto linear = [](float gain) {
    Mlp<float> mlp(MlpShape{.sizes = {4, 1}});
    mlp.weight(0, 0, 0) = gain;
    return write_onnx({mlp}, {});
  };
  const FindFiles find = [&](const std::string&, const Place&) {
    return std::vector<StudyPolicy::File>{{"a.onnx", linear(1)}, {"b.onnx", linear(2)}, {"c.onnx", linear(1)}};
  };
  const std::string text =
      "schema = 1\nname = \"s\"\nplant = { kind = \"cartpole\", preset = \"scg-default\" }\n"
      "[[policy]]\nname = \"net\"\nkind = \"onnx\"\nfile = \"*.onnx\"\n";

  const Study study = parse_study(text, "s.toml", {}, find);

  REQUIRE(study.policies[0].files.size() == 2);
  CHECK(study.policies[0].count() == 2);
  CHECK(study.policies[0].files[1].path == "b.onnx");
  CHECK(study_warnings(study) ==
        Warnings{"policy 'net': c.onnx equals a.onnx byte for byte; the two are one policy and "
                 "count once"});
}
