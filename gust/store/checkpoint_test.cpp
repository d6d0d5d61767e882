#include "gust/store/checkpoint.h"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "gust/store/files_test_folder.h"

using namespace gust;

namespace fs = std::filesystem;

TEST_CASE("the checkpoint that was saved last is loaded") {
  const TestFolder folder;
  const Store store(folder / "store", Store::Access::write);
  const std::string bytes("\0\nstate\xff", 8);

  CHECK(!load_checkpoint(store, "ppo-1"));
  save_checkpoint(store, "ppo-1", "first");
  save_checkpoint(store, "ppo-1", bytes);
  save_checkpoint(store, "ppo-2", "");

  CHECK(load_checkpoint(store, "ppo-1") == bytes);
  CHECK(load_checkpoint(store, "ppo-2") == "");
  remove_checkpoint(store, "ppo-1");
  CHECK(!load_checkpoint(store, "ppo-1"));
}

TEST_CASE("a damaged checkpoint, or one of another trial, counts as none") {
  const TestFolder folder;
  const Store store(folder / "store", Store::Access::write);
  save_checkpoint(store, "ppo-1", "state");
  const fs::path path = folder / "store/checkpoints/ppo-1";
  const std::string good = get_file(path);
  std::size_t refused = 0;

  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x20);
    put_file(path, bad);
    refused += load_checkpoint(store, "ppo-1") ? 0 : 1;
    put_file(path, good.substr(0, i));
    refused += load_checkpoint(store, "ppo-1") ? 0 : 1;
  }
  put_file(folder / "store/checkpoints/ppo-2", good);

  CHECK(refused == 2 * good.size());
  CHECK(!load_checkpoint(store, "ppo-2"));
}

TEST_CASE("a checkpoint goes when its trial is committed, or when a finished trial still has one") {
  const TestFolder folder;
  const Store store(folder / "store", Store::Access::write);
  for (const char* id : {"a", "b"}) save_checkpoint(store, id, "state");

  store.begin("train", "a").commit("");

  CHECK(!load_checkpoint(store, "a"));
  CHECK(load_checkpoint(store, "b"));
  save_checkpoint(store, "a", "late");
  const Store next(folder / "store", Store::Access::write);
  CHECK(!load_checkpoint(next, "a"));
  CHECK(load_checkpoint(next, "b"));
}

TEST_CASE("checkpoints that take long to write are written seldom") {
  using namespace std::chrono_literals;
  CheckpointPace pace(1ms);
  CHECK_FALSE(pace.due());
  std::this_thread::sleep_for(2ms);
  CHECK(pace.due());

  pace.keep([] { std::this_thread::sleep_for(20ms); });
  std::this_thread::sleep_for(100ms);

  CHECK_FALSE(pace.due());  // not before a second has passed
}
