#include "gust/control/closed_loop.h"

#include <cmath>
#include <cstring>

#include "gust/control/adder_plant_test.h"

using namespace gust;

namespace {

/// A constant disturbance at each of the three sites.
std::vector<Injection> constant_everywhere() {
  std::vector<Injection> all;
  all.push_back(disturbance(Site::kObservation, waveform("constant"), 2));
  all.push_back(disturbance(Site::kAction, waveform("constant"), 1));
  all.push_back(disturbance(Site::kDynamics, waveform("constant"), 1));
  return all;
}

struct Chain {
  double commanded, disturbed, applied;
};

/// Commands a policy's action on the adder with a constant disturbance of the action.
Chain chain(const Readings& readings, double command, double disturbance_level) {
  const AdderPlant plant;
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kAction, waveform("constant"), 1));
  ClosedLoop loop(plant, readings, injections, 1);
  loop.begin(0, start_at_zero(plant, injections, {disturbance_level}));
  step_all(loop, command);
  CHECK(loop.state().at(0, 0) == loop.applied().at(0, 0));
  return {loop.commanded().at(0, 0), loop.disturbed().at(0, 0), loop.applied().at(0, 0)};
}

double reward(double a, double u) { return std::exp(-(a * a + 0.5 * u * u)); }

Made<Plant> cartpole() { return plants().at("cartpole").make(Table{{}, {"test"}}); }

}  // namespace

TEST_CASE("one control step: command, disturb, saturate, push, judge the true state, observe with noise") {
  const AdderPlant plant;
  const std::vector<Injection> injections = constant_everywhere();
  ClosedLoop loop(plant, Readings{.effort = "disturbed"}, injections, 1);

  loop.begin(0, start_at_zero(plant, injections, {0.25, 1.5, 3.0}));
  CHECK(loop.observation().at(0, 0) == 0.25);  // reset's observation is disturbed too
  CHECK(loop.observation().at(1, 0) == 0.25);
  CHECK(loop.steps_done(0) == 0);
  step_all(loop, 0.5);

  CHECK(loop.commanded().at(0, 0) == 1.0);  // half of 2
  CHECK(loop.disturbed().at(0, 0) == 2.5);
  CHECK(loop.applied().at(0, 0) == 2.5);
  CHECK(loop.force().at(0, 0) == 3.0);
  CHECK(loop.state().at(0, 0) == 2.5);
  CHECK(loop.state().at(1, 0) == 3.0);
  CHECK(loop.observation().at(0, 0) == 2.75);
  CHECK(loop.observation().at(1, 0) == 3.25);
  CHECK(loop.reward()[0] == doctest::Approx(reward(2.5, 2.5)).epsilon(1e-14));
  CHECK(loop.steps_done(0) == 1);
}

TEST_CASE("saturate after: the disturbed sum is clipped to the actuator's bounds, the command is not") {
  const Chain inside = chain({}, 0.5, 1.0);
  const Chain beyond = chain({}, 1.5, 3.0);
  const Chain wild = chain({}, 5.0, -7.0);

  CHECK(inside.applied == 2.0);
  CHECK(beyond.disturbed == 6.0);
  CHECK(beyond.applied == 4.0);
  CHECK(beyond.commanded == 3.0);
  CHECK(wild.commanded == 4.0);  // what could be had of 10
  CHECK(wild.disturbed == 3.0);  // 10 - 7: the command entered whole
  CHECK(wild.applied == 3.0);
}

TEST_CASE("saturate before: the command is clipped to its box, then disturbed, and not clipped again") {
  const Readings before{.saturate = "before"};

  CHECK(chain(before, 5.0, 3.0).disturbed == 5.0);
  CHECK(chain(before, 5.0, 3.0).applied == 5.0);
  CHECK(chain(before, 0.5, 3.0).applied == 4.0);
}

TEST_CASE("command_clip = box clips what the policy says to [-1, 1] of its unit; none lets it through") {
  CHECK(chain({.command_clip = "box"}, 5.0, 0.5).disturbed == 2.5);
  CHECK(chain({.command_clip = "none"}, 5.0, 0.5).disturbed == 10.5);
}

TEST_CASE("effort chooses which action the reward charges") {
  const AdderPlant plant;
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kAction, waveform("constant"), 1));
  const auto reward_of = [&](const char* effort) {
    ClosedLoop loop(plant, Readings{.effort = effort}, injections, 1);
    loop.begin(0, start_at_zero(plant, injections, {4.5}));
    step_all(loop, 0.5);
    CHECK(loop.reward_commanded()[0] == doctest::Approx(reward(4.0, 1.0)).epsilon(1e-14));
    CHECK(loop.reward_disturbed()[0] == doctest::Approx(reward(4.0, 5.5)).epsilon(1e-14));
    return loop.reward()[0];
  };

  CHECK(reward_of("commanded") == doctest::Approx(reward(4.0, 1.0)).epsilon(1e-14));
  CHECK(reward_of("disturbed") == doctest::Approx(reward(4.0, 5.5)).epsilon(1e-14));
  CHECK(reward_of("applied") == doctest::Approx(reward(4.0, 4.0)).epsilon(1e-14));
}

TEST_CASE("a unit disturbance changes its own target and nothing that comes before it") {
  const AdderPlant plant;
  const std::vector<Injection> injections = constant_everywhere();
  const auto run = [&](std::vector<double> levels) {
    auto loop = std::make_unique<ClosedLoop>(plant, Readings{}, injections, 1);
    loop->begin(0, start_at_zero(plant, injections, std::move(levels)));
    step_all(*loop, 0.5);
    return loop;
  };
  const auto calm = run({0, 0, 0});

  const auto seen = run({1, 0, 0});
  CHECK(seen->observation().at(0, 0) - calm->observation().at(0, 0) == 1.0);
  CHECK(seen->observation().at(1, 0) - calm->observation().at(1, 0) == 1.0);
  CHECK(seen->state().at(0, 0) == calm->state().at(0, 0));
  CHECK(seen->disturbed().at(0, 0) == calm->disturbed().at(0, 0));
  CHECK(seen->reward()[0] == calm->reward()[0]);

  const auto moved = run({0, 1, 0});
  CHECK(moved->disturbed().at(0, 0) - calm->disturbed().at(0, 0) == 1.0);
  CHECK(moved->commanded().at(0, 0) == calm->commanded().at(0, 0));
  CHECK(moved->force().at(0, 0) == calm->force().at(0, 0));
  CHECK(moved->state().at(0, 0) - calm->state().at(0, 0) == 1.0);
  CHECK(moved->state().at(1, 0) == calm->state().at(1, 0));

  const auto pushed = run({0, 0, 1});
  CHECK(pushed->force().at(0, 0) - calm->force().at(0, 0) == 1.0);
  CHECK(pushed->applied().at(0, 0) == calm->applied().at(0, 0));
  CHECK(pushed->state().at(1, 0) - calm->state().at(1, 0) == 1.0);
  CHECK(pushed->state().at(0, 0) == calm->state().at(0, 0));
}

TEST_CASE("a step at offset 2 acts in the third control step, and shows in the observation that it returns") {
  const AdderPlant plant;
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kDynamics, waveform("step"), 1));
  injections.push_back(disturbance(Site::kObservation, waveform("step"), 2));
  ClosedLoop loop(plant, Readings{}, injections, 1);
  loop.begin(0, start_at_zero(plant, injections, {1.0, 100.0}));
  std::vector<double> forces;
  std::vector<double> noise = {loop.observation().at(0, 0)};

  for (int k = 0; k < 4; ++k) {
    step_all(loop, 0.0);
    forces.push_back(loop.force().at(0, 0));
    noise.push_back(loop.observation().at(0, 0));
  }

  CHECK(forces == std::vector<double>{0, 0, 1, 1});
  CHECK(noise == std::vector<double>{0, 0, 0, 100, 100});
}

TEST_CASE("offsets are added to the disturbances of their sites") {
  const AdderPlant plant;
  const std::vector<Injection> injections = constant_everywhere();
  ClosedLoop loop(plant, Readings{}, injections, 1);
  loop.begin(0, start_at_zero(plant, injections, {0.0, 0.5, 1.0}));
  const Matrix<double> command(1, 1, 0.5);
  const Matrix<double> force_offset(1, 1, 2.0);
  const Matrix<double> action_offset(1, 1, -0.25);
  const Matrix<double> observation_offset(1, 1, 10.0);

  loop.step(command.view(),
            {.observation = observation_offset.view(), .action = action_offset.view(), .force = force_offset.view()});

  CHECK(loop.disturbed().at(0, 0) == 1.25);
  CHECK(loop.force().at(0, 0) == 3.0);
  CHECK(loop.commanded().at(0, 0) == 1.0);
  CHECK(loop.state().at(0, 0) == 1.25);
  CHECK(loop.observation().at(0, 0) == 11.25);
  CHECK(loop.observation().at(1, 0) == 3.0);
}

TEST_CASE("noise scales linearly with the level, lane by lane, from one shared signal") {
  const AdderPlant plant;
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kDynamics, waveform("white"), 1));
  ClosedLoop loop(plant, Readings{}, injections, 3);
  const EpisodeStart start = start_at_zero(plant, injections, {1.0});
  for (std::size_t lane = 0; lane < 3; ++lane) {
    EpisodeStart own = start;
    own.levels = {lane == 0 ? 0.0 : lane == 1 ? 0.5 : 4.0};
    loop.begin(lane, own);
  }

  for (int k = 0; k < 8; ++k) {
    step_all(loop, 0.0);
    CHECK(loop.force().at(0, 0) == 0.0);
    CHECK(loop.force().at(0, 2) == 8.0 * loop.force().at(0, 1));
    CHECK(loop.force().at(0, 1) == 0.5 * start.signals->channel(0, 0)[k]);
  }
}

TEST_CASE("failure is judged on the true state, strictly, and NaN has failed") {
  const AdderPlant plant;
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kObservation, waveform("constant"), 2));
  ClosedLoop loop(plant, Readings{}, injections, 4);
  const double starts[] = {98.0, std::nextafter(98.0, 99.0), 0.0, 0.0};
  for (std::size_t lane = 0; lane < 4; ++lane) {
    EpisodeStart start = start_at_zero(plant, injections, {lane == 2 ? 1000.0 : 0.0});
    start.state = {starts[lane], lane == 3 ? NAN : 0.0};
    loop.begin(lane, start);
  }

  step_all(loop, 1.0);  // a grows by 2

  CHECK_FALSE(loop.failed(0));  // exactly 100
  CHECK(loop.failed(1));
  CHECK_FALSE(loop.failed(2));  // it only looks as if
  CHECK(loop.failed(3));
}

TEST_CASE("the reward takes an angle modulo a turn") {
  AdderPlant plant;
  plant.spec_.state_weights = {0, 1};
  ClosedLoop loop(plant, Readings{}, {}, 2);
  loop.begin(0, {{0, 0.5}, {1.0}, {}, {}});
  loop.begin(1, {{0, 0.5 + 8 * std::acos(-1.0)}, {1.0}, {}, {}});

  step_all(loop, 0.0);

  CHECK(loop.reward()[0] == doctest::Approx(std::exp(-0.25)).epsilon(1e-14));
  CHECK(loop.reward()[1] == doctest::Approx(std::exp(-0.25)).epsilon(1e-13));
}

TEST_CASE("a lane gives the same bits alone and among others that begin at other times") {
  const Made<Plant> plant = cartpole();
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kObservation, waveform("white"), 4));
  injections.push_back(disturbance(Site::kAction, waveform("sine"), 1));
  injections.push_back(disturbance(Site::kDynamics, waveform("uniform"), 2));
  constexpr std::size_t kLanes = 13;
  const auto start = [&](std::size_t lane, std::uint64_t episode) {
    const Rng rng = Rng(5).split(episode);
    return EpisodeStart{random_start(plant->spec(), rng),
                        {0.4 + 0.01 * static_cast<double>(lane), 0.1, 1.0},
                        {0.01, 0.5 * static_cast<double>(lane), 0.1},
                        std::make_shared<Signals>(injections, plant->spec(), rng)};
  };
  ClosedLoop many(*plant, Readings{}, injections, kLanes);
  ClosedLoop one(*plant, Readings{}, injections, 1);
  for (std::size_t lane = 0; lane < kLanes; ++lane) many.begin(lane, start(lane, lane));
  Matrix<double> command(1, kLanes);
  constexpr std::size_t kWatched = 11;

  for (int k = 0; k < 60; ++k) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) command.at(0, lane) = many.observation().at(2, lane) * 4.0;
    many.step(command.view());
    if (k == 20) many.begin(kWatched, start(kWatched, 99));
    if (k % 7 == 0) many.begin(3, start(3, static_cast<std::uint64_t>(k)));
  }
  one.begin(0, start(kWatched, 99));
  for (int k = 21; k < 60; ++k) {
    const Matrix<double> own(1, 1, one.observation().at(2, 0) * 4.0);
    one.step(own.view());
  }

  CHECK(one.steps_done(0) == 39);
  CHECK(many.steps_done(kWatched) == 39);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(one.state().at(i, 0) == many.state().at(i, kWatched));
    CHECK(one.observation().at(i, 0) == many.observation().at(i, kWatched));
  }
  CHECK(one.reward()[0] == many.reward()[kWatched]);
}

TEST_CASE("every lane has its own parameters") {
  const AdderPlant plant;
  ClosedLoop loop(plant, Readings{}, {}, 2);
  loop.begin(0, {{0, 0}, {1.0}, {}, {}});
  loop.begin(1, {{0, 0}, {3.0}, {}, {}});

  step_all(loop, 0.5);

  CHECK(loop.state().at(0, 0) == 1.0);
  CHECK(loop.state().at(0, 1) == 3.0);
}

TEST_CASE("steps beyond the horizon hold the last values of the disturbance") {
  const AdderPlant plant;
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kDynamics, waveform("white"), 1));
  ClosedLoop loop(plant, Readings{}, injections, 1);
  const EpisodeStart start = start_at_zero(plant, injections, {1.0});
  loop.begin(0, start);

  for (int k = 0; k < 20; ++k) step_all(loop, 0.0);

  CHECK(loop.force().at(0, 0) == start.signals->channel(0, 0)[8]);
}

TEST_CASE("random starts fill the training distribution and are the episode's own") {
  const AdderPlant plant;
  double least = 9, most = -9;

  for (std::uint64_t episode = 0; episode < 1000; ++episode) {
    const std::vector<double> state = random_start(plant.spec(), Rng(1).split(episode));
    least = std::min(least, state[0]);
    most = std::max(most, state[0]);
    CHECK(state[1] == -1.0);
  }

  CHECK(least >= 0.5);
  CHECK(least < 0.51);
  CHECK(most < 1.5);
  CHECK(most > 1.49);
  CHECK(random_start(plant.spec(), Rng(7)) == random_start(plant.spec(), Rng(7)));
  CHECK(nominal_parameters(plant.spec()) == std::vector<double>{1.0});
}

TEST_CASE("a moving reference is compared with and shown one step ahead, and stands still at its end") {
  AdderPlant plant;
  plant.spec_.references = 3;  // 0, 10, 20
  plant.spec_.horizon = 2;
  for (const std::size_t lag : {0u, 1u}) {
    plant.spec_.reference_lag = lag;
    ClosedLoop loop(plant, Readings{}, {}, 1);
    loop.begin(0, {{0, 0}, {1.0}, {}, {}, 0});
    REQUIRE(loop.observation().rows == 6);
    CHECK(loop.observation().at(2, 0) == 10.0);  // the first observation never lags
    CHECK(loop.observation().at(4, 0) == 20.0);

    step_all(loop, 0.0);

    CHECK(loop.goal().at(0, 0) == (lag == 0 ? 10.0 : 0.0));
    CHECK(loop.observation().at(2, 0) == (lag == 0 ? 20.0 : 10.0));
    CHECK(loop.observation().at(4, 0) == 20.0);

    step_all(loop, 0.0);
    step_all(loop, 0.0);
    CHECK(loop.goal().at(0, 0) == 20.0);
    CHECK(loop.observation().at(2, 0) == 20.0);
  }
}

TEST_CASE("noise of the observation leaves the references alone") {
  AdderPlant plant;
  plant.spec_.references = 3;
  plant.spec_.horizon = 1;
  const std::vector<Injection> injections = {disturbance(Site::kObservation, waveform("constant"), 2)};
  ClosedLoop loop(plant, Readings{}, injections, 1);
  loop.begin(0, start_at_zero(plant, injections, {3.0}));

  CHECK(loop.observation().at(0, 0) == 3.0);
  CHECK(loop.observation().at(1, 0) == 3.0);
  CHECK(loop.observation().at(2, 0) == 10.0);
  CHECK(loop.observation().at(3, 0) == 0.0);
}
