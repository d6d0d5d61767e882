#include "gust/store/store.h"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "gust/core/hash.h"
#include "gust/core/version.h"
#include "gust/store/files_test_folder.h"

using namespace gust;

namespace fs = std::filesystem;

namespace {

/// A store in a folder of its own, and what it told.
struct TestStore {
  TestStore()
      : store(folder / "store", Store::Access::write, [this](const std::string& text) { told += text + "\n"; }) {}

  fs::path operator/(const fs::path& name) const { return folder / "store" / name; }

  TestFolder folder;
  std::string told;
  Store store;
};

void commit_trial(const Store& store, std::string_view id, std::string_view content = "numbers") {
  TrialWriter writer = store.begin("sweep", id);
  writer.write("rows.bin", content);
  writer.write("note.txt", "");
  writer.commit(cat("kind = sweep, id = ", id));
}

/// What opening a store says.
std::string opening(const fs::path& folder, Store::Access access) {
  return message_of([&] { Store(folder, access); });
}

}  // namespace

TEST_CASE("a trial is there after its commit, whole, with its text") {
  const TestStore test;
  TrialWriter writer = test.store.begin("sweep", "lqr-step-01");
  OutputFile& file = writer.file("rows.bin");
  file.append("num");
  file.append("bers");
  CHECK(!test.store.has("sweep", "lqr-step-01"));
  CHECK(!test.store.load("sweep", "lqr-step-01"));

  writer.commit("kind = sweep");

  REQUIRE(test.store.has("sweep", "lqr-step-01"));
  const auto trial = test.store.load("sweep", "lqr-step-01");
  REQUIRE(trial);
  CHECK(trial->read("rows.bin") == "numbers");
  CHECK(std::string(std::istreambuf_iterator<char>(trial->open("rows.bin").rdbuf()), {}) == "numbers");
  CHECK(trial->contains("rows.bin"));
  CHECK(!trial->contains("rows"));
  CHECK(
      trial->manifest ==
      Manifest{"sweep", "lqr-step-01", "kind = sweep", std::string(kVersion), {{"rows.bin", 7, hash_hex("numbers")}}});
  CHECK(test.store.trials() == std::vector<std::pair<std::string, std::string>>{{"sweep", "lqr-step-01"}});
  CHECK(test.told == "");
}

TEST_CASE("a trial that is not committed leaves nothing behind") {
  const TestStore test;
  const auto before = count_below(test.folder.path());

  {
    TrialWriter writer = test.store.begin("sweep", "a");
    writer.write("rows.bin", std::string(300'000, 'x'));
  }

  CHECK(!test.store.has("sweep", "a"));
  CHECK(count_below(test.folder.path()) == before);
}

TEST_CASE("of two equal results of one trial the first stays and the second is quiet") {
  const TestStore test;
  const Store other(test / "", Store::Access::write);
  TrialWriter first = test.store.begin("sweep", "a");
  TrialWriter second = other.begin("sweep", "a");
  first.write("rows.bin", "first");
  second.write("rows.bin", "first");

  first.commit("");
  second.commit("");

  CHECK(test.store.load("sweep", "a")->read("rows.bin") == "first");
  CHECK(test.told == "");
  CHECK(!fs::exists(test / "damaged"));
}

TEST_CASE("two results for one trial raise an alarm that names both, and the first stays") {
  const TestStore test;
  TrialWriter first = test.store.begin("sweep", "a");
  TrialWriter second = test.store.begin("sweep", "a");
  first.write("rows.bin", "first");
  second.write("rows.bin", "second");
  second.write("curve.csv", "1");

  first.commit("");
  second.commit("");

  CHECK(test.store.load("sweep", "a")->read("rows.bin") == "first");
  CHECK(test.store.disagreements() == 1);
  CHECK(test.told == cat("two results for one trial: ", (test / "sweep/a").string(), " (gust ", kVersion, ") and ",
                         (test / "damaged/sweep-a-1").string(), " (gust ", kVersion,
                         ") differ in curve.csv, rows.bin; equal text must give equal bits, so one machine or program "
                         "computes wrongly: run the trial on a third\n"));
  CHECK(describe_file(test / "damaged/sweep-a-1/rows.bin").size == 6);
}

TEST_CASE("networks of two versions may differ, what they did may not") {
  const Manifest first{"train", "a", "", "0.1.0", {{"policy.onnx", 1, "aa"}, {"curve.csv", 1, "bb"}}};
  Manifest second = first;
  second.gust = "0.2.0";
  second.files[0].hash = "cc";

  CHECK(differing_files(first, second).empty());
  second.files[1].hash = "cc";
  CHECK(differing_files(first, second) == std::vector<std::string>{"curve.csv"});
  second.gust = first.gust;
  CHECK(differing_files(first, second) == std::vector<std::string>{"curve.csv", "policy.onnx"});
}

TEST_CASE("many threads with two stores on one folder commit and load the same trials") {
  const TestStore test;
  const Store other(test / "", Store::Access::write);
  std::atomic<int> wrong = 0;

  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 6; ++i) {
      threads.emplace_back([&, i] {
        const Store& store = i % 2 == 0 ? test.store : other;
        for (int trial = 0; trial < 30; ++trial) {
          commit_trial(store, cat(trial));
          const auto stored = store.load("sweep", cat(trial));
          wrong += stored && stored->read("rows.bin") == "numbers" ? 0 : 1;
        }
      });
    }
  }

  CHECK(wrong == 0);
  CHECK(test.store.trials().size() == 30);
  CHECK(!fs::exists(test / "damaged"));
}

TEST_CASE("any damage to a trial is reported, moved away, and made good by the next commit") {
  const std::string manifest = "sweep/a/manifest.json";
  const std::vector<std::pair<std::function<void(const TestStore&)>, std::string>> damages = {
      {[](const TestStore& t) { put_file(t / "sweep/a/rows.bin", "numbars"); }, "rows.bin: its hash differs"},
      {[](const TestStore& t) { put_file(t / "sweep/a/rows.bin", "number"); }, "rows.bin: has 6 bytes, not 7"},
      {[](const TestStore& t) { fs::remove(t / "sweep/a/note.txt"); }, "note.txt: cannot read: No such file"},
      {[&](const TestStore& t) { put_file(t / manifest, ""); }, "damaged manifest: not a JSON object"},
      {[&](const TestStore& t) { fs::remove(t / manifest); }, "manifest.json: cannot read: No such file"},
      {[&](const TestStore& t) { put_file(t / manifest, get_file(t / manifest).substr(0, 100)); }, "not a JSON object"},
      {[&](const TestStore& t) {
         std::string bytes = get_file(t / manifest);
         bytes[bytes.find("kind = sweep")] = 'K';
         put_file(t / manifest, bytes);
       },
       "damaged manifest: its hash differs"},
      {[&](const TestStore& t) {
         put_file(t / manifest, manifest_bytes({"sweep", "b", "", "", {}}));
       },
       "is of another trial"},
  };
  for (const auto& [damage, expected] : damages) {
    TestStore test;
    commit_trial(test.store, "a");

    damage(test);

    CHECK(!test.store.load("sweep", "a"));
    CHECK_MESSAGE(test.told.find(expected) != std::string::npos, test.told);
    CHECK(test.told.find("damaged/sweep-a-1 and is computed again") != std::string::npos);
    CHECK(fs::exists(test / "damaged/sweep-a-1"));
    CHECK(!test.store.has("sweep", "a"));
    commit_trial(test.store, "a");
    CHECK(test.store.load("sweep", "a")->read("rows.bin") == "numbers");
  }
}

TEST_CASE("a commit replaces what lies in its place without a manifest, and counts what is moved away") {
  TestStore test;
  put_file(test / "sweep/a/junk", "");
  put_file(test / "damaged/sweep-a-1", "");

  commit_trial(test.store, "a");

  CHECK(test.store.load("sweep", "a"));
  CHECK(fs::exists(test / "damaged/sweep-a-2/junk"));
}

TEST_CASE("a store that is open for reading is not changed") {
  TestStore test;
  commit_trial(test.store, "a");
  put_file(test / "sweep/a/rows.bin", "numbars");
  std::string told;
  const auto before = count_below(test.folder.path());

  const Store store(test / "", Store::Access::read, [&](const std::string& text) { told += text; });

  CHECK(!store.load("sweep", "a"));
  CHECK(told.find("rows.bin: its hash differs; 'gust store repair ") != std::string::npos);
  CHECK(store.has("sweep", "a"));
  CHECK(count_below(test.folder.path()) == before);
}

TEST_CASE("what is no store of this format is one clear error") {
  const TestFolder folder;
  const std::string base = folder.path().string();
  using enum Store::Access;

  put_file(folder / "file", "");
  put_file(folder / "other/letter.txt", "");
  put_file(folder / "newer/store.json", R"({"format":7,"gust":"9.1.0"})");
  put_file(folder / "broken/store.json", R"({"format")");

  CHECK(opening(folder / "none", read) == base + "/none: no store lies here; gust run makes one");
  CHECK(opening(folder / "other", read) ==
        cat(base, "/other: has no store.json; 'gust store repair ", base, "/other' writes one if this is a store"));
  CHECK(opening(folder / "file", write) == base + "/file: cannot make the folder: Not a directory");
  CHECK(opening(folder / "other", write) == base + "/other: holds other things than a store; choose another folder");
  CHECK(opening(folder / "broken", write) ==
        cat(base, "/broken/store.json: damaged; 'gust store repair ", base, "/broken' writes it again"));
  for (const auto access : {read, write}) {
    CHECK(opening(folder / "newer", access) == cat(base, "/newer: a store of format 7, made by gust 9.1.0; gust ",
                                                   kVersion,
                                                   " reads format 1: use that version, or choose another folder"));
  }
  CHECK(opening("/proc/gust-test", write).starts_with("/proc/gust-test: cannot make the folder: "));
  CHECK(count_below(folder / "newer") == 1);
}

TEST_CASE("what a dead process left aside is removed, what a living one writes is not") {
  const TestStore test;
  TrialWriter writer = test.store.begin("sweep", "alive");
  writer.write("rows.bin", "numbers");
  const pid_t child = ::fork();
  if (child == 0) {
    const Store store(test / "", Store::Access::write);
    TrialWriter unfinished = store.begin("sweep", "dead");
    unfinished.write("rows.bin", std::string(200'000, 'x'));
    ::_exit(0);  // as a kill: nothing is cleaned up
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(fs::exists(test / cat("aside/", child, "-0.lock")));
  put_file(test / "aside/1-5/0/rows.bin", "a folder without a lock");

  const Store next(test / "", Store::Access::write);

  CHECK(!fs::exists(test / cat("aside/", child, "-0")));
  CHECK(!fs::exists(test / cat("aside/", child, "-0.lock")));
  CHECK(!fs::exists(test / "aside/1-5"));
  writer.commit("");
  CHECK(next.load("sweep", "alive"));
}

TEST_CASE("names that could leave the store are our mistake") {
  const TestStore test;

  for (const char* id : {"", "..", ".a", "a/b", "/a", "a b"}) {
    CHECK_THROWS_AS(test.store.begin("sweep", id), Bug);
    CHECK_THROWS_AS(test.store.has("sweep", id), Bug);
  }
  for (const char* kind : {"aside", "damaged", "checkpoints", "../x"})
    CHECK_THROWS_AS(test.store.begin(kind, "a"), Bug);
  TrialWriter writer = test.store.begin("sweep", "a");
  CHECK_THROWS_AS(writer.file("manifest.json"), Bug);
  CHECK_THROWS_AS(writer.file("../x"), Bug);
}
