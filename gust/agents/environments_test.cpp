#include "gust/agents/environments.h"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "gust/control/adder_plant_test.h"

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

TEST_CASE("a ramp goes on through the episodes of an environment, from saved bytes too") {
  const auto plant = cartpole(20);
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kObservation, waveform("scg_ramp"), 4));
  injections.front().level = 1e6;  // never reached: it rises by 0.16 an episode
  const TrainingTask task{plant.object.get(), {}, injections, 1};
  Environments whole(task, 2, Rng(1)), resumed(task, 2, Rng(1));

  push(whole, 60, 0.0);  // three episodes; the fourth begins at rest
  Saver saver;
  whole.save(saver);
  const std::string bytes = saver.take();
  Loader loader(bytes);
  resumed.load(loader);

  for (std::size_t lane = 0; lane < 2; ++lane) {
    const double seen = whole.observation().at(1, lane);
    CHECK(std::abs(seen - (3 * 21 + 1) * 0.00798) < 5 * 0.00603 * 8);  // as many values, and five standard errors
    CHECK(resumed.observation().at(1, lane) == seen);
  }
}

TEST_CASE("what an effect remembers goes on from saved bytes as if it had never stopped, at every site") {
  const auto plant = cartpole(40);
  std::vector<Injection> injections;
  for (const char* site : {"observation", "action", "dynamics"}) {
    Table table{{{"site", Value{std::string(site), {}}}, {"effect", Value{std::string("delay"), {}}}}, {}};
    table.set("level", {0.033, {}});
    if (site == std::string("dynamics")) injections.push_back(disturbance(Site::kDynamics, waveform("white"), 2));
    injections.push_back(read_injection(table, plant->spec()));
  }
  const TrainingTask task{plant.object.get(), {}, injections, 1};
  Environments whole(task, 3, Rng(1)), resumed(task, 3, Rng(1));

  push(whole, 57, 1.0);  // in the second episode
  Saver saver;
  whole.save(saver);
  const std::string bytes = saver.take();
  Loader loader(bytes);
  resumed.load(loader);

  for (int k = 0; k < 10; ++k) {
    for (std::size_t lane = 0; lane < 3; ++lane) {
      for (std::size_t i = 0; i < 4; ++i) CHECK(whole.observation().at(i, lane) == resumed.observation().at(i, lane));
    }
    push(whole, 1, -1.0);
    push(resumed, 1, -1.0);
  }
}

TEST_CASE("8.8.1 a drawn parameter holds over its episode and changes at every reset") {
  const AdderPlant plant;  // a grows by gain * u a step: what it grew by is the gain that was drawn
  const Place place{"test"};
  const Value range{Table{{{"low", {0.25, place}}, {"high", {4.0, place}}}, place}, place};
  const Randomisation randomisation = read_randomisation({{{"gain", range}}, place}, plant.spec());
  Environments environments({&plant, {}, {}, 1, randomisation.draws}, 3, Rng(1));
  const Matrix<double> command(1, 3, 0.5);  // u = 1 N
  std::set<double> gains;

  for (int episode = 0; episode < 20; ++episode) {
    std::array<double, 3> gain{};
    for (std::int64_t step = 0; step < plant.spec().steps; ++step) {
      std::array<double, 3> before{};
      for (std::size_t lane = 0; lane < 3; ++lane) before[lane] = environments.observation().at(0, lane);
      environments.step(command.view());
      for (std::size_t lane = 0; lane < 3; ++lane) {
        const bool last = environments.done()[lane];
        const double after = (last ? environments.terminal_observation() : environments.observation()).at(0, lane);
        if (step == 0) gain[lane] = after - before[lane];
        CHECK(after - before[lane] == doctest::Approx(gain[lane]).epsilon(1e-12));  // sums round
      }
    }
    for (const double value : gain) {
      CHECK((value > 0.249 && value < 4.001));
      CHECK(gains.insert(value).second);  // never the same twice
    }
  }
}

TEST_CASE("environments with drawn parameters go on from saved bytes as if they had never stopped") {
  const auto plant = cartpole();
  const Place place{"test"};
  const Value range{Table{{{"low", {0.2, place}}, {"high", {1.0, place}}}, place}, place};
  const Randomisation randomisation = read_randomisation({{{"pole_length", range}}, place}, plant->spec());
  const TrainingTask task{plant.object.get(), {}, {}, 1, randomisation.draws};
  Environments whole(task, 3, Rng(1)), resumed(task, 3, Rng(1));
  push(whole, 60, 0.4);

  Saver saver;
  whole.save(saver);
  const std::string bytes = saver.take();
  Loader loader(bytes);
  resumed.load(loader);

  push(whole, 1, 0.4);
  push(resumed, 1, 0.4);
  for (std::size_t lane = 0; lane < 3; ++lane)
    CHECK(whole.observation().at(2, lane) == resumed.observation().at(2, lane));
}

TEST_CASE("environments with an adversary go on from saved bytes as if they had never stopped, at every site") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 1};
  for (const Site site : kSites) {
    const AdversarySite against{.site = site, .scale = 0.5};
    Environments whole(task, 3, Rng(1), against), resumed(task, 3, Rng(1), against);
    const auto step = [&](Environments& environments, std::uint64_t k) {
      const Matrix<double> command(1, 3, 0.3);
      Matrix<double> adversary(environments.channels(), 3);
      for (std::size_t i = 0; i < adversary.rows(); ++i)
        for (std::size_t lane = 0; lane < 3; ++lane) adversary.at(i, lane) = Rng(6).split(lane).normal(4 * k + i);
      environments.step(command.view(), adversary.view());
    };
    for (std::uint64_t k = 0; k < 90; ++k) step(whole, k);

    Saver saver;
    whole.save(saver);
    const std::string bytes = saver.take();
    Loader loader(bytes);
    resumed.load(loader);

    for (Environments* environments : {&whole, &resumed}) step(*environments, 90);
    for (std::size_t lane = 0; lane < 3; ++lane) {
      for (std::size_t i = 0; i < 4; ++i) CHECK(whole.observation().at(i, lane) == resumed.observation().at(i, lane));
    }
  }
}

TEST_CASE("8.5.8 environments whose adversary gives nothing are the plain ones, to the bit") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 1};
  for (const Site site : kSites) {
    Environments plain(task, 2, Rng(1)), against(task, 2, Rng(1), AdversarySite{.site = site, .scale = 0.1});
    const Matrix<double> nothing(against.channels(), 2);
    Matrix<double> command(1, 2);
    for (std::uint64_t k = 0; k < 300; ++k) {
      for (std::size_t lane = 0; lane < 2; ++lane) command.at(0, lane) = 0.3 * Rng(2).split(lane).normal(k);
      plain.step(command.view());
      against.step(command.view(), nothing.view());
      for (std::size_t lane = 0; lane < 2; ++lane) {
        REQUIRE(plain.reward()[lane] == against.reward()[lane]);
        for (std::size_t i = 0; i < 4; ++i)
          REQUIRE(plain.observation().at(i, lane) == against.observation().at(i, lane));
      }
    }
  }
}

TEST_CASE("environments that restart begin new episodes") {
  const auto plant = cartpole();
  Environments environments({plant.object.get(), {}, {}, 1}, 2, Rng(1));
  push(environments, 10, 0.1);

  const double first = Environments({plant.object.get(), {}, {}, 1}, 2, Rng(1)).observation().at(0, 0);
  environments.restart();

  CHECK(environments.observation().at(1, 0) == 0.0);  // at rest
  CHECK(environments.observation().at(0, 0) != first);
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
