#include "gust/agents/environments.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace gust;

namespace {

Made<Plant> cartpole(std::int64_t steps = 250) {
  return plants().make({{{"kind", Value{std::string("cartpole"), {}}}, {"steps", Value{steps, {}}}}, {}});
}

/// Pushes every environment to one side and on, so that some episodes fail and their lengths differ.
void push(Environments& environments, int steps, double force) {
  Matrix<double> command(1, environments.count());
  for (int k = 0; k < steps; ++k) {
    for (std::size_t lane = 0; lane < environments.count(); ++lane)
      command.at(0, lane) = force * (lane % 2 == 0 ? 1.0 : -0.3);
    environments.step(command.view());
  }
}

}  // namespace

TEST_CASE("an episode that ends in time is truncated, not failed, and the next begins") {
  const auto plant = cartpole(3);
  Environments environments({plant.object.get(), {}, {}, 1}, 2, Rng(1));
  const double first = environments.observation().at(0, 0);

  push(environments, 2, 0.0);
  CHECK_FALSE(environments.done()[0]);
  push(environments, 1, 0.0);

  CHECK(environments.done()[0]);
  CHECK(environments.truncated()[0]);
  CHECK(environments.observation().at(0, 0) != first);
  CHECK(environments.observation().at(1, 0) == 0.0);  // a start: at rest
  CHECK(environments.terminal_observation().at(1, 0) != 0.0);
}

TEST_CASE("an episode that fails is done and not truncated") {
  const auto plant = cartpole();
  Environments environments({plant.object.get(), {}, {}, 1}, 1, Rng(1));
  int steps = 0;

  for (; steps < 250; ++steps) {
    push(environments, 1, 1.0);
    if (environments.done()[0]) break;
  }

  CHECK(steps < 249);
  CHECK_FALSE(environments.truncated()[0]);
  const double x = environments.terminal_observation().at(0, 0), theta = environments.terminal_observation().at(2, 0);
  CHECK((std::abs(x) > 2.4 || std::abs(theta) > 1.5707));
}

TEST_CASE("an environment's episodes do not depend on how many others there are") {
  const auto plant = cartpole(20);
  Environments one({plant.object.get(), {}, {}, 1}, 1, Rng(1));
  Environments many({plant.object.get(), {}, {}, 1}, 7, Rng(1));

  push(one, 50, 0.1);
  push(many, 50, 0.1);

  for (std::size_t i = 0; i < 4; ++i) CHECK(one.observation().at(i, 0) == many.observation().at(i, 0));
}

TEST_CASE("environments go on from saved bytes as if they had never stopped") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 1};
  Environments whole(task, 5, Rng(1));
  Environments resumed(task, 5, Rng(1));
  push(whole, 130, 0.7);

  Saver saver;
  whole.save(saver);
  const std::string bytes = saver.take();
  Loader loader(bytes);
  resumed.load(loader);
  loader.finish();

  push(whole, 1, 0.7);
  push(resumed, 1, 0.7);
  for (std::size_t lane = 0; lane < 5; ++lane) {
    for (std::size_t i = 0; i < 4; ++i) CHECK(whole.observation().at(i, lane) == resumed.observation().at(i, lane));
    CHECK(whole.reward()[lane] == resumed.reward()[lane]);
  }
}

TEST_CASE("bytes that are no environments are an error") {
  const auto plant = cartpole();
  Environments environments({plant.object.get(), {}, {}, 1}, 2, Rng(1));
  push(environments, 30, 0.1);
  Saver saver;
  environments.save(saver);
  const std::string bytes = saver.take();

  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Loader loader(std::string_view(bytes).substr(0, size));
    CHECK_THROWS_AS(environments.load(loader), Error);
  }
  std::string huge = bytes;
  huge[7] = '\x7f';  // a count beyond all memory
  Loader loader(huge);
  CHECK_THROWS_AS(environments.load(loader), Error);
}
