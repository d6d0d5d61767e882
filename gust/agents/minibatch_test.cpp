#include "gust/agents/minibatch.h"

#include <doctest/doctest.h>

#include <array>

using namespace gust;

TEST_CASE("every input of a minibatch has the parts of its transition in their order") {
  Replay replay({.observations = 2, .actions = 1, .extras = 1}, 10);
  const std::array observation = {1.0f, 2.0f}, next = {3.0f, 4.0f};
  const std::array action = {5.0f}, extra = {6.0f};
  replay.add({observation, action, extra, next, 7.0f, false});
  replay.add({next, extra, action, observation, 8.0f, true});
  Minibatch batch(replay.shape(), 70);
  std::vector<std::int64_t> rows(70, 0);
  rows[69] = 1;

  batch.gather(replay, rows);

  const auto lane = [](const Tiles<float>& tiles, std::size_t index) {
    std::vector<float> values;
    for (std::size_t i = 0; i < tiles.features(); ++i) values.push_back(tiles.at(index, i));
    return values;
  };
  CHECK(lane(batch.observation, 0) == std::vector<float>{1, 2, 6});
  CHECK(lane(batch.next, 0) == std::vector<float>{3, 4, 6});
  CHECK(lane(batch.taken, 0) == std::vector<float>{1, 2, 5, 6});
  CHECK(lane(batch.acted, 0) == std::vector<float>{1, 2, 0, 6});
  CHECK(lane(batch.next_acted, 0) == std::vector<float>{3, 4, 0, 6});
  CHECK(lane(batch.taken, 69) == std::vector<float>{3, 4, 6, 5});
  CHECK(batch.reward[0] == 7.0f);
  CHECK(batch.alive[0] == 1.0f);
  CHECK(batch.alive[69] == 0.0f);

  batch.set_extra(3, 0, 9.0f);
  for (const Tiles<float>* tiles : {&batch.observation, &batch.next, &batch.taken, &batch.acted, &batch.next_acted})
    CHECK(tiles->at(3, tiles->features() - 1) == 9.0f);
}
