#include <doctest/doctest.h>

#include <cmath>

#include "gust/control/closed_loop.h"

using namespace gust;

namespace {

Made<Plant> plant_of(const std::string& kind, double control_rate, double physics_rate) {
  return plants().make({{{"kind", Value{kind, {}}},
                         {"control_rate", Value{control_rate, {}}},
                         {"physics_rate", Value{physics_rate, {}}}},
                        {}});
}

Injection injection_of(const Plant& plant, const std::string& text_site, const std::string& shape, Value options) {
  Table table{{{"site", Value{text_site, {}}}, {shape, std::move(options)}}, {}};
  return read_injection(table, plant.spec());
}
Injection delay_at(const Plant& plant, const std::string& site) {
  return injection_of(plant, site, "effect", Value{std::string("delay"), {}});
}

EpisodeStart start_of(const Plant& plant, std::span<const Injection> injections, std::vector<double> levels) {
  return {plant.spec().start, nominal_parameters(plant.spec()), std::move(levels),
          std::make_shared<Signals>(injections, plant.spec(), Rng(1)), 0};
}

/// A command for step k in the physical unit of an action that is not normalised.
double command(std::int64_t k) { return std::sin(0.7 * static_cast<double>(k)) + 0.3; }

std::vector<double> state_of(const ClosedLoop& loop, std::size_t lane = 0) {
  std::vector<double> state;
  for (std::size_t i = 0; i < loop.state().rows; ++i) state.push_back(loop.state().at(i, lane));
  return state;
}

constexpr int kSteps = 12, kSubsteps = 20;

}  // namespace

TEST_CASE(
    "a late action moves the cart-pole as a controller of the physics' rate that gives it that late, to the bit") {
  const auto plant = plant_of("cartpole", 50, 1000), fine = plant_of("cartpole", 1000, 1000);
  const std::vector<Injection> injections = {delay_at(*plant, "action")};
  for (const int ticks : {0, 1, 7, 19, 20, 33, 40}) {
    CAPTURE(ticks);
    ClosedLoop loop(*plant, Readings{}, injections, 1);
    ClosedLoop reference(*fine, Readings{}, {}, 1);
    loop.begin(0, start_of(*plant, injections, {ticks / 1000.0}));
    reference.begin(0, start_of(*fine, {}, {}));

    for (int k = 0; k < kSteps; ++k) {
      loop.step(Matrix<double>(1, 1, command(k)).view());
      for (int s = 0; s < kSubsteps; ++s) {
        const int given = k * kSubsteps + s - ticks;  // the substep whose command arrives now
        reference.step(Matrix<double>(1, 1, given < 0 ? 0.0 : command(given / kSubsteps)).view());
      }
      CHECK(state_of(loop) == state_of(reference));
    }
  }
}

TEST_CASE("a late observation shows the state of that time before, to the bit") {
  const auto plant = plant_of("cartpole", 50, 1000), fine = plant_of("cartpole", 1000, 1000);
  const std::vector<Injection> injections = {delay_at(*plant, "observation")};
  for (const int ticks : {0, 1, 13, 20, 47}) {
    CAPTURE(ticks);
    ClosedLoop loop(*plant, Readings{}, injections, 1);
    ClosedLoop reference(*fine, Readings{}, {}, 1);
    loop.begin(0, start_of(*plant, injections, {ticks / 1000.0}));
    reference.begin(0, start_of(*fine, {}, {}));
    std::vector<std::vector<double>> states = {state_of(reference)};

    for (int k = 0; k < kSteps; ++k) {
      loop.step(Matrix<double>(1, 1, command(k)).view());
      for (int s = 0; s < kSubsteps; ++s) {
        reference.step(Matrix<double>(1, 1, command(k)).view());
        states.push_back(state_of(reference));
      }
      const int shown = std::max(0, (k + 1) * kSubsteps - ticks);
      for (std::size_t i = 0; i < 4; ++i)
        CHECK(loop.observation().at(i, 0) == states[static_cast<std::size_t>(shown)][i]);
    }
  }
}

TEST_CASE("a late force is the disturbance before it in the list, that late; one behind it is not") {
  const auto plant = plant_of("cartpole", 50, 1000);
  const auto sine = [&] {
    const Table options{{{"kind", Value{std::string("sine"), {}}}, {"frequency", Value{3.0, {}}}}, {}};
    return injection_of(*plant, "dynamics", "waveform", Value{options, {}});
  };
  const auto forces = [&](const std::vector<Injection>& injections, std::vector<double> levels) {
    ClosedLoop loop(*plant, Readings{}, injections, 1);
    loop.begin(0, start_of(*plant, injections, std::move(levels)));
    std::vector<double> forces;
    for (int k = 0; k < kSteps; ++k) {
      loop.step(Matrix<double>(1, 1, 0.0).view());
      forces.push_back(loop.force().at(0, 0));
    }
    return forces;
  };
  const std::vector<double> plain = forces({sine()}, {2});

  const std::vector<double> late = forces({sine(), delay_at(*plant, "dynamics")}, {2, 0.04});
  for (std::size_t k = 0; k < late.size(); ++k) CHECK(late[k] == (k < 2 ? 0.0 : plain[k - 2]));
  CHECK(forces({delay_at(*plant, "dynamics"), sine()}, {0.04, 2}) == plain);
}

TEST_CASE("a delay of 0 changes no bit, at any site of any plant, beside lanes that are late") {
  for (const std::string& kind : plants().names()) {
    CAPTURE(kind);
    const auto plant = plants().make({{{"kind", Value{kind, {}}}}, {}});
    const PlantSpec& spec = plant->spec();
    const std::vector<Injection> injections = {delay_at(*plant, "observation"), delay_at(*plant, "action"),
                                               delay_at(*plant, "dynamics")};
    ClosedLoop plain(*plant, Readings{}, {}, 1), loop(*plant, Readings{}, injections, 6);
    plain.begin(0, start_of(*plant, {}, {}));
    for (std::size_t lane = 0; lane < 6; ++lane) {
      const double level = lane == 3 ? 0.0 : 0.0137 * static_cast<double>(lane + 1);
      loop.begin(lane, start_of(*plant, injections, {level, level, level}));
    }

    for (int k = 0; k < kSteps; ++k) {
      Matrix<double> one(spec.action.size(), 1), all(spec.action.size(), 6);
      for (std::size_t i = 0; i < spec.action.size(); ++i) {
        const double physical = spec.action_goal[i] * (1 + 0.1 * command(k + static_cast<int>(i)));
        one.at(i, 0) = (physical - spec.action_offset[i]) / spec.action_scale[i];
        for (std::size_t lane = 0; lane < 6; ++lane) all.at(i, lane) = one.at(i, 0);
      }
      plain.step(one.view());
      loop.step(all.view());
      CHECK(state_of(loop, 3) == state_of(plain));
      for (std::size_t i = 0; i < spec.observations(); ++i)
        CHECK(loop.observation().at(i, 3) == plain.observation().at(i, 0));
      CHECK(loop.reward()[3] == plain.reward()[0]);
    }
  }
}

TEST_CASE("outside its window an effect changes nothing, and within it remembers what came before") {
  const auto plant = plant_of("cartpole", 50, 1000);
  std::vector<Injection> injections = {delay_at(*plant, "action")};
  injections.front().start = 3;
  injections.front().end = 6;
  ClosedLoop loop(*plant, Readings{}, injections, 1);
  loop.begin(0, start_of(*plant, injections, {0.04}));
  std::vector<double> applied;

  for (int k = 0; k < 8; ++k) {
    loop.step(Matrix<double>(1, 1, (1.0 + k) / 16).view());
    applied.push_back(1.6 * loop.applied().at(0, 0));  // the command is a share of 10 N
  }

  CHECK(applied == std::vector<double>{1, 2, 3, 2, 3, 4, 7, 8});
}
