#include <doctest/doctest.h>

#include <cmath>

#include "gust/core/math.h"
#include "gust/core/rng.h"
#include "gust/sim/plant.h"

using namespace gust;

namespace {

using Options = std::initializer_list<std::pair<std::string, Value>>;

Made<Plant> quadrotor(Options options = {}) {
  Table table{{}, {"test"}};
  for (const auto& option : options) table.items.push_back(option);
  return plants().at("quadrotor").make(table);
}

Value number(double value) { return {value, {"test"}}; }
Value word(const char* value) { return {std::string(value), {"test"}}; }

struct Batch {
  Matrix<double> state, parameters, action, force;

  Batch(const Plant& plant, std::size_t lanes)
      : state(plant.spec().state.size() + plant.spec().hidden, lanes),
        parameters(2, lanes),
        action(2, lanes),
        force(2, lanes) {
    for (std::size_t p = 0; p < 2; ++p) std::ranges::fill(parameters.row(p), plant.spec().parameters[p].nominal);
  }
  void begin(const Plant& plant, std::size_t lane, const std::array<double, 6>& at, bool moving = false) {
    for (std::size_t i = 0; i < 6; ++i) state.at(i, lane) = at[i];
    plant.begin(state.view(), lane, moving);
  }
  Motion motion() { return {state.view(), parameters.view(), action.view(), force.view()}; }
};

constexpr double kHover = 0.027 * 9.8 / 2;

}  // namespace

TEST_CASE("half the weight on each pair of rotors keeps a quadrotor where it is") {
  for (const char* artefacts : {"clean", "scg"}) {
    const auto plant = quadrotor({{"artefacts", word(artefacts)}});
    Batch batch(*plant, 1);
    batch.begin(*plant, 0, {0.3, 0, 1, 0, 0, 0});
    for (std::size_t i = 0; i < 2; ++i) batch.action.at(i, 0) = kHover;

    for (int k = 0; k < 100; ++k) plant->advance(batch.motion());

    CHECK(batch.state.at(0, 0) == 0.3);
    CHECK(std::abs(batch.state.at(2, 0) - 1.0) < 1e-13);
    CHECK(batch.state.at(4, 0) == 0.0);
  }
}

TEST_CASE("a falling, turning quadrotor follows the closed form of semi-implicit Euler") {
  const auto plant = quadrotor({{"floor", number(-100)}});
  Batch batch(*plant, 1);
  batch.begin(*plant, 0, {0, 0.5, 1, 0, 0, 0});
  batch.action.at(0, 0) = -1e-4;  // a pure moment, no thrust
  batch.action.at(1, 0) = 1e-4;

  plant->advance(batch.motion());

  const double n = 20, dt = 1e-3, turn = 0.028 * 2e-4 / 1.4e-5;
  CHECK(batch.state.at(0, 0) == doctest::Approx(0.5 * n * dt));
  CHECK(batch.state.at(3, 0) == doctest::Approx(-9.8 * n * dt));
  CHECK(batch.state.at(2, 0) == doctest::Approx(1.0 - 9.8 * dt * dt * n * (n + 1) / 2));
  CHECK(batch.state.at(5, 0) == doctest::Approx(turn * n * dt));
  CHECK(batch.state.at(4, 0) == doctest::Approx(turn * dt * dt * n * (n + 1) / 2));
}

TEST_CASE("the floor ends a fall, says so, and lets go again") {
  const auto plant = quadrotor();
  Batch batch(*plant, 2);
  for (std::size_t lane = 0; lane < 2; ++lane) batch.begin(*plant, lane, {0, 0, lane == 0 ? 0.0 : 5.0, 0, 0, 0});
  const std::size_t contact = *plant->spec().contact;

  for (int k = 0; k < 10; ++k) plant->advance(batch.motion());  // 0.2 s of free fall: 0.2 m

  CHECK(batch.state.at(2, 0) == -0.0365);
  CHECK(batch.state.at(3, 0) == 0.0);
  CHECK(batch.state.at(contact, 0) == 1.0);
  CHECK(batch.state.at(contact, 1) == 0.0);

  for (std::size_t i = 0; i < 2; ++i) batch.action.at(i, 0) = 0.2;
  for (int k = 0; k < 10; ++k) plant->advance(batch.motion());
  CHECK(batch.state.at(2, 0) > 0.05);
  CHECK(batch.state.at(contact, 0) == 1.0);  // it did touch
}

TEST_CASE("damping takes away v (c + c |v|)") {
  const auto plant = quadrotor({{"damping", number(0.04)}, {"physics_rate", number(50)}});
  Batch batch(*plant, 1);
  batch.begin(*plant, 0, {0, 0.6, 1, 0.8, 0, -2});
  for (std::size_t i = 0; i < 2; ++i) batch.action.at(i, 0) = kHover;

  plant->advance(batch.motion());

  const double drag = 0.04 + 0.04 * 1.0;
  CHECK(batch.state.at(1, 0) == doctest::Approx(0.6 - 0.02 * 0.6 * drag));
  CHECK(batch.state.at(3, 0) == doctest::Approx(0.8 - 0.02 * 0.8 * drag));
  CHECK(batch.state.at(5, 0) == doctest::Approx(-2 + 0.02 * 2 * (0.04 + 0.04 * 2)));
}

TEST_CASE("a quadrotor's lane does not depend on its neighbours") {
  const auto plant = quadrotor({{"artefacts", word("scg")}});
  Batch many(*plant, 13), one(*plant, 1);
  const Rng rng(7);
  for (std::size_t lane = 0; lane < 13; ++lane) {
    std::array<double, 6> at;
    for (std::size_t i = 0; i < 6; ++i) at[i] = 0.3 * rng.normal(13 * i + lane);
    many.begin(*plant, lane, at);
    if (lane == 11) one.begin(*plant, 0, at);
    for (std::size_t i = 0; i < 2; ++i) many.force.at(i, lane) = 0.02 * static_cast<double>(lane == 11);
  }
  for (std::size_t i = 0; i < 2; ++i) one.force.at(i, 0) = 0.02;

  for (int k = 0; k < 50; ++k) {
    plant->advance(many.motion());
    plant->advance(one.motion());
  }

  for (std::size_t i = 0; i < 12; ++i) CHECK(one.state.at(i, 0) == many.state.at(i, 11));
}

TEST_CASE("the circle starts at the bottom and is run through once") {
  const auto plant = quadrotor();
  CHECK(plant->spec().references == 251);
  CHECK(plant->spec().observations() == 12);
  const double turn = 2 * kPi / 5;
  for (const std::size_t sample : {0u, 1u, 77u, 250u}) {
    const double t = static_cast<double>(sample) / 50;
    double at[6];
    plant->reference(sample, at);
    CHECK(at[0] == doctest::Approx(-0.5 * std::sin(turn * t)).epsilon(1e-13));
    CHECK(at[1] == doctest::Approx(-0.5 * turn * std::cos(turn * t)).epsilon(1e-13));
    CHECK(at[2] == doctest::Approx(0.5 - 0.5 * std::cos(turn * t)).epsilon(1e-13));
    CHECK(at[3] == doctest::Approx(0.5 * turn * std::sin(turn * t)).epsilon(1e-13));
  }
}

TEST_CASE("masses that cannot hover follow from the actuator and from the action box") {
  const auto mass = quadrotor()->spec().parameters[0];
  CHECK(mass.by_box.low == doctest::Approx(0.9 * 0.027));
  CHECK(mass.by_box.high == doctest::Approx(1.1 * 0.027));
  CHECK(mass.by_actuator.low == doctest::Approx(2 * 0.0563233755 / 9.8));
  CHECK(mass.by_actuator.high == doctest::Approx(2 * 0.2966828942 / 9.8));
}

TEST_CASE("impossible quadrotors are refused") {
  CHECK_THROWS_WITH_AS(quadrotor({{"thrust_low", number(0.5)}}),
                       "test: 'thrust_low' must be below 'thrust_high', got 0.5 and 0.2966828942298889", Error);
  CHECK_THROWS_WITH_AS(quadrotor({{"z_high", number(-1)}}), "test: 'z_low' must be below 'z_high', got -0.05 and -1",
                       Error);
  CHECK_THROWS_AS(quadrotor({{"start", number(1)}}), Error);
  CHECK_THROWS_AS(quadrotor({{"mass", number(0)}}), Error);
  CHECK_THROWS_AS(quadrotor({{"physics_rate", number(75)}}), Error);
}
