#include <doctest/doctest.h>

#include <cmath>

#include "gust/core/math.h"
#include "gust/core/rng.h"
#include "gust/sim/plant.h"

using namespace gust;

namespace {

Made<Plant> cartpole(std::initializer_list<std::pair<std::string, Value>> options = {}) {
  Table table{{{"kind", Value{std::string("cartpole"), {}}}}, {"test"}};
  for (const auto& option : options) table.items.push_back(option);
  return plants().make(table);
}

Value number(double value) { return {value, {"test"}}; }

struct Batch {
  Matrix<double> state, parameters, action, force;

  Batch(const Plant& plant, std::size_t lanes)
      : state(plant.spec().state.size(), lanes), parameters(3, lanes), action(1, lanes), force(2, lanes) {
    for (std::size_t p = 0; p < 3; ++p) {
      for (double& value : parameters.row(p)) value = plant.spec().parameters[p].nominal;
    }
  }
  Motion motion() { return {state.view(), parameters.view(), action.view(), force.view()}; }
};

/// Kinetic plus potential energy with the box inertia.
double energy(const double* s) {
  const double m = 0.1, l = 0.5, M = 1.0, g = 9.8;
  const double inertia = m / 12 * (0.05 * 0.05 + 4 * l * l);
  return 0.5 * (M + m) * s[1] * s[1] + m * l * s[1] * s[3] * std::cos(s[2]) +
         0.5 * (inertia + m * l * l) * s[3] * s[3] + m * g * l * std::cos(s[2]);
}

}  // namespace

TEST_CASE("a free cart-pole keeps its energy as the integration step goes to zero") {
  double errors[2];

  for (int i = 0; i < 2; ++i) {
    const auto plant = cartpole({{"control_rate", number(10)}, {"physics_rate", number(i == 0 ? 1e4 : 1e5)}});
    Batch batch(*plant, 1);
    batch.state.at(2, 0) = 0.5;
    const double start[] = {0, 0, 0.5, 0};
    for (int k = 0; k < 10; ++k) plant->advance(batch.motion());
    const double end[] = {batch.state.at(0, 0), batch.state.at(1, 0), batch.state.at(2, 0), batch.state.at(3, 0)};
    errors[i] = std::abs(energy(end) - energy(start));
  }

  CHECK(errors[0] < 1e-3);
  CHECK(errors[1] < errors[0] / 5);  // first order: a tenth of the step, a tenth of the error
}

TEST_CASE("a lane's bits do not depend on its neighbours") {
  const auto plant = cartpole();
  Batch many(*plant, 13);
  Batch one(*plant, 1);
  const Rng rng(7);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t lane = 0; lane < 13; ++lane) many.state.at(i, lane) = rng.normal(13 * i + lane);
    one.state.at(i, 0) = many.state.at(i, 11);
  }

  for (int k = 0; k < 50; ++k) {
    plant->advance(many.motion());
    plant->advance(one.motion());
  }

  for (std::size_t i = 0; i < 4; ++i) CHECK(one.state.at(i, 0) == many.state.at(i, 11));
}

TEST_CASE("the linearisation is the derivative of one control step") {
  const auto plant = cartpole();
  const double at[] = {0.1, -0.4, 0.3, 0.8};
  const double action[] = {2.0};

  const Linearisation exact = plant->linearise(at, action);

  const double h = 1e-6;
  for (int input = 0; input < 5; ++input) {
    Batch batch(*plant, 2);
    for (int lane = 0; lane < 2; ++lane) {
      for (int i = 0; i < 4; ++i) batch.state.at(i, lane) = at[i];
      batch.action.at(0, lane) = action[0];
      (input < 4 ? batch.state.at(input, lane) : batch.action.at(0, lane)) += lane == 0 ? h : -h;
    }
    plant->advance(batch.motion());
    for (int i = 0; i < 4; ++i) {
      const double difference = (batch.state.at(i, 0) - batch.state.at(i, 1)) / (2 * h);
      CHECK(difference == doctest::Approx(input < 4 ? exact.a(i, input) : exact.b(i, 0)).epsilon(1e-7));
    }
  }
}

TEST_CASE("a tap at the tip turns the pole twice as much as one at its middle") {
  double turned[2];

  for (int i = 0; i < 2; ++i) {
    const auto plant = cartpole({{"tap_point", Value{std::string(i == 0 ? "com" : "tip"), {}}},
                                 {"cart_mass", number(1e9)},  // a cart that stands still
                                 {"physics_rate", number(50)}});
    Batch batch(*plant, 1);
    batch.force.at(0, 0) = 1.0;
    plant->advance(batch.motion());
    turned[i] = batch.state.at(3, 0);
  }

  CHECK(turned[1] == doctest::Approx(2 * turned[0]));
}

TEST_CASE("the rail caps the outward speed and turns the pole") {
  const auto plant = cartpole({{"physics_rate", number(50)}});
  Batch batch(*plant, 1);
  batch.state.at(0, 0) = 15.01;
  batch.state.at(1, 0) = 3.0;

  plant->advance(batch.motion());

  const double cap = -0.2 * (15.01 - 15.0) / 0.02;
  CHECK(batch.state.at(1, 0) == doctest::Approx(cap));
  CHECK(batch.state.at(3, 0) == doctest::Approx(-(0.1 * 0.5) / (0.1 / 12 * (0.0025 + 1) + 0.025) * (cap - 3.0)));
}

TEST_CASE("rates that do not divide are refused") {
  CHECK_THROWS_WITH_AS(cartpole({{"physics_rate", number(75)}}),
                       "test: 'physics_rate' must be a whole multiple of 'control_rate', got 75 and 50", Error);
}
