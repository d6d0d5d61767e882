#include "gust/control/adversary.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/control/adder_plant_test.h"

using namespace gust;

namespace {

Matrix<double> filled(std::size_t rows, double value) { return Matrix<double>(rows, 1, value); }

double value_of(const AdversarySite& at, double action) {
  Matrix<double> value = filled(1, action);
  adversary_value(at, value.view(), value.view());
  return value.at(0, 0);
}

/// A loop of the adder at rest at zero.
ClosedLoop loop_at_zero(const AdderPlant& plant) {
  ClosedLoop loop(plant, {.effort = "disturbed"}, {}, 1);
  loop.begin(0, {{0, 0}, {1.0}, {}, nullptr});
  return loop;
}

}  // namespace

TEST_CASE("8.5.4 an adversary's action is clipped to the unit before it is scaled") {
  CHECK(value_of({.scale = 0.1}, 5.0) == 0.1);
  CHECK(value_of({.scale = 0.1}, -5.0) == -0.1);
  CHECK(value_of({.scale = 0.5}, 0.25) == 0.125);
  CHECK(value_of({.scale = 0.5, .offset = 2.0}, -3.0) == 1.5);
}

TEST_CASE("8.5.4 over a million steps no force leaves offset plus or minus scale") {
  const auto plant = plants().make({{{"kind", Value{std::string("cartpole"), {}}}}, {}});
  constexpr std::size_t kLanes = 500;
  constexpr std::int64_t kSteps = 2000;
  const AdversarySite at{.scale = 0.5, .offset = 0.25};  // exact in binary: no bound is missed by rounding
  ClosedLoop loop(*plant, {}, {}, kLanes);
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    loop.begin(lane, {random_start(plant->spec(), Rng(lane)), nominal_parameters(plant->spec()), {}, nullptr});
  const Matrix<double> command(1, kLanes);
  Matrix<double> value(2, kLanes);
  double greatest = 0;
  bool touched = false;

  for (std::int64_t k = 0; k < kSteps; ++k) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      for (std::size_t i = 0; i < 2; ++i) value.at(i, lane) = 1.5 * Rng(9).split(lane).normal(2 * k + i);
    }
    adversary_value(at, value.view(), value.view());
    step_against(loop, command.view(), at.site, value.view());
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      for (std::size_t i = 0; i < 2; ++i) greatest = std::max(greatest, std::abs(loop.force().at(i, lane) - at.offset));
    }
    touched = touched || greatest == at.scale;
  }

  CHECK(greatest == at.scale);
  CHECK(touched);
}

TEST_CASE("an adversary pushes at its site, for one step") {
  const AdderPlant plant;
  const Matrix<double> command = filled(1, 0.5), rest = filled(1, 0.0);  // u = 1 N

  ClosedLoop pushed = loop_at_zero(plant);
  step_against(pushed, command.view(), Site::kDynamics, filled(1, 0.25).view());
  CHECK(pushed.state().at(1, 0) == 0.25);
  step_against(pushed, command.view(), Site::kDynamics, rest.view());
  CHECK(pushed.state().at(1, 0) == 0.25);

  ClosedLoop moved = loop_at_zero(plant);
  step_against(moved, command.view(), Site::kAction, filled(1, 0.25).view());
  CHECK(moved.applied().at(0, 0) == 1.25);
  step_against(moved, command.view(), Site::kAction, filled(1, 5.0).view());
  CHECK(moved.disturbed().at(0, 0) == 6.0);
  CHECK(moved.applied().at(0, 0) == 4.0);  // the actuator's bound

  ClosedLoop misled = loop_at_zero(plant);
  step_against(misled, command.view(), Site::kObservation, filled(2, 0.25).view());
  CHECK(misled.state().at(0, 0) == 1.0);
  CHECK(misled.observation().at(0, 0) == 1.25);
  CHECK(misled.observation().at(1, 0) == 0.25);
  misled.step(command.view());
  CHECK(misled.observation().at(0, 0) == 2.0);
}

TEST_CASE("8.5.8 an adversary that gives nothing leaves the loop as it is, to the bit") {
  const auto plant = plants().make({{{"kind", Value{std::string("cartpole"), {}}}}, {}});
  for (const Site site : kSites) {
    ClosedLoop plain(*plant, {}, {}, 3), against(*plant, {}, {}, 3);
    for (std::size_t lane = 0; lane < 3; ++lane) {
      const EpisodeStart start{random_start(plant->spec(), Rng(lane)), nominal_parameters(plant->spec()), {}, nullptr};
      plain.begin(lane, start);
      against.begin(lane, start);
    }
    Matrix<double> value(channels_of(site, plant->spec()).size(), 3);
    adversary_value({.site = site, .scale = 0.1}, value.view(), value.view());
    for (std::uint64_t k = 0; k < 200; ++k) {
      const Matrix<double> command(1, 3, 0.2 * Rng(2).normal(k));
      plain.step(command.view());
      step_against(against, command.view(), site, value.view());
    }
    for (std::size_t lane = 0; lane < 3; ++lane) {
      for (std::size_t i = 0; i < 4; ++i) CHECK(plain.observation().at(i, lane) == against.observation().at(i, lane));
      CHECK(plain.reward()[lane] == against.reward()[lane]);
    }
  }
}
