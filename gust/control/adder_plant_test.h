#pragma once

#include <doctest/doctest.h>

#include "gust/control/closed_loop.h"
#include "gust/disturb/waveform_fixture_test.h"

namespace gust {

/// A plant whose arithmetic can be done in the head: states a and b; in a control step a grows by gain * u, b by f.
/// The policy's action is in [-1, 1] for u in [-2, 2]; the actuator gives [-4, 4]; failure beyond |a| = 100. Reward
/// exp(-(a^2 + u^2 / 2)), 8 control steps at 10 Hz.
class AdderPlant final : public Plant {
 public:
  AdderPlant() {
    spec_.state = {{"a", "m"}, {"b", "m"}};
    spec_.action = {{"u", "N"}};
    spec_.force = {{"f", "N"}};
    spec_.parameters = {{"gain", "1", 1.0}};
    spec_.control_rate = 10;
    spec_.physics_rate = 10;
    spec_.steps = 8;
    spec_.normalized_action = true;
    spec_.action_scale = {2};
    spec_.action_offset = {0};
    spec_.action_low = {-4};
    spec_.action_high = {4};
    spec_.start = {1, -1};
    spec_.start_offset = {0, 0};
    spec_.start_range = {0.5, 0};
    spec_.fail_low = {-100, -INFINITY};
    spec_.fail_high = {100, INFINITY};
    spec_.wraps = {false, true};
    spec_.state_weights = {1, 0};
    spec_.action_weight = 0.5;
    spec_.action_goal = {0};
    spec_.error_weights = {0, 1};
  }

  const PlantSpec& spec() const override { return spec_; }
  void advance(const Motion& motion) const noexcept override {
    for (std::size_t lane = 0; lane < motion.state.lanes; ++lane) {
      motion.state.at(0, lane) += motion.parameters.at(0, lane) * motion.action.at(0, lane);
      motion.state.at(1, lane) += motion.force.at(0, lane);
    }
  }
  void reference(std::size_t sample, std::span<double> state) const noexcept override {
    state[0] = 10.0 * static_cast<double>(sample);  // of which there is one, at 0, unless a test says otherwise
    state[1] = 0.0;
  }
  void begin(Rows<double>, std::size_t, bool) const noexcept override {}
  bool near_ground(std::span<const double>) const noexcept override { return false; }
  Linearisation linearise(std::span<const double>, std::span<const double>) const override {
    throw Bug("not linearised");
  }

  PlantSpec spec_;
};

/// A disturbance of every channel of a site of the adder.
inline Injection disturbance(Site site, Made<Waveform> shape, std::size_t channels) {
  Injection injection;
  injection.site = site;
  injection.waveform = std::move(shape);
  injection.factors.assign(channels, 1.0);
  return injection;
}

/// A start of the adder at zero, with a level for each injection.
inline EpisodeStart start_at_zero(const Plant& plant, std::span<const Injection> injections, std::vector<double> levels,
                                  Rng episode = Rng(1)) {
  return {{0, 0}, {1.0}, std::move(levels), std::make_shared<Signals>(injections, plant.spec(), episode), 0};
}

/// One step of every lane with the same command.
inline void step_all(ClosedLoop& loop, double command) {
  const Matrix<double> commands(1, loop.lanes(), command);
  loop.step(commands.view());
}

}  // namespace gust
