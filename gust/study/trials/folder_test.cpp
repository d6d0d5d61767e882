#include "gust/study/trials/folder.h"

#include <doctest/doctest.h>

#include "gust/onnx/onnx.h"
#include "gust/store/files.h"
#include "gust/store/files_test_folder.h"
#include "gust/study/text/study_fixture.h"

using namespace gust;
using namespace gust::test;

namespace {

/// A study over two policy files, and the folder that a run of it would leave.
struct Scene {
  ScratchFolder scratch{"gust-folder"};
  std::filesystem::path study = scratch.path / "study.toml";
  StudyFolder kept{scratch.path / "kept.gust"};

  Scene() {
    Mlp<float> policy({{4, 2, 1}});
    write_file_atomically(scratch.path / "policies/a.onnx", write_onnx({policy}, {}));
    policy.parameters()[0] = 1.0f;
    write_file_atomically(scratch.path / "policies/b.onnx", write_onnx({policy}, {}));
    write_file_atomically(study, changed("kind = \"zero\"", "kind = \"onnx\"\nfile = \"policies/*.onnx\""));
    kept.keep(StudyFolder::read(study, {"evaluate.episodes=2"}), {"study.toml", {"evaluate.episodes=2"}});
  }
};

}  // namespace

TEST_CASE("a kept study is read back without the files that it was made from") {
  const Scene scene;
  std::filesystem::remove_all(scene.scratch.path / "policies");
  std::filesystem::remove(scene.study);

  const Study study = scene.kept.open();

  CHECK(study.episodes == 2);
  CHECK(scene.kept.inputs().study == "study.toml");
  CHECK(scene.kept.inputs().settings == std::vector<std::string>{"evaluate.episodes=2"});
  REQUIRE(study.policies[1].count() == 2);
  CHECK(study.policies[1].member(0) == "policies/a.onnx");
  CHECK(study.policies[1].member(1) == "policies/b.onnx");
}

TEST_CASE("what of a kept study was touched is named, and the next run writes it again") {
  const Scene scene;
  const std::string text = read_file(scene.kept.path() / "study.toml");
  const std::string inputs = read_file(scene.kept.path() / "inputs.json");
  const auto touched = [&](const char* file, const std::string& bytes) {
    write_file_atomically(scene.kept.path() / file, bytes);
    return message_of([&] { scene.kept.open(); });
  };
  const auto names = [&](const std::string& message, const char* file) {
    return message.starts_with(cat((scene.kept.path() / file).string(), ": is not what the run wrote"));
  };

  CHECK(names(touched("study.toml", text + "\n"), "study.toml"));
  CHECK(touched("study.toml", text) == "");
  std::string other = inputs;
  other.replace(other.find("episodes=2"), 10, "episodes=3");
  CHECK(names(touched("inputs.json", other), "inputs.json"));
  CHECK(touched("inputs.json", inputs) == "");
}

TEST_CASE("a file of a kept study that was damaged is one clear error") {
  const Scene scene;
  const std::filesystem::path inputs = scene.kept.path() / "inputs.json";
  const std::string good = read_file(inputs);

  for (const char* bad : {"", "{", "[]", "{\"settings\": 3, \"files\": []}", "{\"settings\": [], \"files\": [[3]]}",
                          "{\"settings\": [], \"files\": [[{\"path\": \"a\"}]]}"}) {
    CAPTURE(bad);
    write_file_atomically(inputs, bad);
    CHECK_THROWS_WITH_AS(scene.kept.open(), doctest::Contains("inputs.json: damaged; run the study again"), Error);
  }
  write_file_atomically(inputs, good);
  for (const auto& entry : std::filesystem::directory_iterator(scene.kept.path() / "inputs"))
    write_file_atomically(entry.path(), "another policy");
  CHECK_THROWS_WITH_AS(scene.kept.open(), doctest::Contains("damaged; run the study again"), Error);
}

TEST_CASE("a folder that holds something else is not taken for results") {
  const Scene scene;
  const Study study = StudyFolder::read(scene.study, {});

  CHECK_THROWS_WITH_AS(StudyFolder(scene.scratch.path / "policies").keep(study, {}),
                       doctest::Contains("is not empty and no result of gust"), Error);
  CHECK_THROWS_WITH_AS(StudyFolder(scene.scratch.path / "policies/a.onnx").keep(study, {}),
                       doctest::Contains("is not a folder"), Error);
  CHECK_THROWS_WITH_AS(StudyFolder(scene.scratch.path / "policies").open(), doctest::Contains("holds no study"), Error);
}
