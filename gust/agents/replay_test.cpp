#include "gust/agents/replay.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

using namespace gust;

namespace {

constexpr TransitionShape kShape{.observations = 2, .actions = 1, .extras = 1};

/// Transition number `i`: every part of it says so.
void add(Replay& replay, int i) {
  const auto number = static_cast<float>(i);
  const std::array observation = {number, -number}, next = {number + 1, -number - 1};
  const std::array action = {number / 2}, extra = {0.25f};
  replay.add({observation, action, extra, next, 10 * number, i % 2 == 1});
}

}  // namespace

TEST_CASE("a row holds a transition as it was, and the oldest goes when the memory is full") {
  Replay replay(kShape, 3);
  for (int i = 0; i < 5; ++i) add(replay, i);

  CHECK(replay.size() == 3);
  std::vector<float> rewards;
  for (int i = 0; i < 3; ++i) rewards.push_back(replay.row(i)[kShape.reward_at()]);
  CHECK(rewards == std::vector<float>{30, 40, 20});
  const auto row = replay.row(0);
  CHECK(std::vector<float>(row.begin(), row.end()) == std::vector<float>{3, -3, 1.5f, 0.25f, 4, -4, 30, 0});
  CHECK(replay.row(1)[kShape.alive_at()] == 1.0f);
}

TEST_CASE("samples are uniform over what is filled, with replacement") {
  Replay replay(kShape, 1000);
  for (int i = 0; i < 10; ++i) add(replay, i);
  std::vector<std::int64_t> drawn(100'000);

  replay.sample(Rng(1), drawn);

  std::array<double, 10> counts{};
  for (const std::int64_t index : drawn) counts.at(static_cast<std::size_t>(index)) += 1.0;
  double chi_square = 0.0;
  for (const double count : counts) chi_square += (count - 1e4) * (count - 1e4) / 1e4;
  CHECK(chi_square < 27.9);  // 9 degrees of freedom, p = 0.001
}

TEST_CASE("a memory that is saved and loaded is the same to the bit, and holds what was filled alone") {
  for (const int count : {0, 2, 3, 7}) {
    Replay replay(kShape, 3);
    for (int i = 0; i < count; ++i) add(replay, i);
    Saver saver;
    replay.save(saver);
    const std::string bytes = saver.take();
    CHECK(bytes.size() == 24 + static_cast<std::size_t>(std::min(count, 3)) * kShape.width() * 4);

    Replay again(kShape, 3);
    Loader loader(bytes);
    again.load(loader);
    loader.finish();
    add(replay, 100);
    add(again, 100);
    Saver first, second;
    replay.save(first);
    again.save(second);
    CHECK(first.take() == second.take());
  }
}

TEST_CASE("bytes of another memory, or damaged ones, are an error") {
  Replay replay(kShape, 10);
  for (int i = 0; i < 5; ++i) add(replay, i);
  Saver saver;
  replay.save(saver);
  const std::string bytes = saver.take();
  const auto load = [](const TransitionShape& shape, std::int64_t capacity, std::string_view from) {
    Replay into(shape, capacity);
    Loader loader(from);
    into.load(loader);
  };

  CHECK_THROWS_AS(load({3, 1, 1}, 10, bytes), Error);
  CHECK_THROWS_AS(load(kShape, 4, bytes), Error);
  for (std::size_t size = 0; size < bytes.size(); size += 7)
    CHECK_THROWS_AS(load(kShape, 10, std::string_view(bytes).substr(0, size)), Error);
  std::string damaged = bytes;
  damaged[8] = 77;  // where the next goes
  CHECK_THROWS_AS(load(kShape, 10, damaged), Error);
}

TEST_CASE("the bytes of a memory are those of its numbers") { CHECK(replay_bytes(kShape, 1'000'000) == 32'000'000); }
