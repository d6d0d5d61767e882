#include <algorithm>
#include <cmath>

#include "gust/control/actuator.h"
#include "gust/control/loop_source.h"
#include "gust/core/math.h"

namespace gust {
namespace {

constexpr double kGoal = 20.0;  // degC

/// A room that a heater of u [W] warms, and a sensor that lags behind. Outside it is 0 degC.
///
///   capacity T' = u - loss T      T temperature of the room [degC]
///   lag y' = T - y                y what the sensor shows [degC], all that a policy sees
///
/// Explicit Euler, one step a second. The reward is exp(-((T - 20) / 2)^2); an episode fails outside 10 to 30 degC.
struct Thermostat {
  double power = 1000.0;
  double capacity = 5000.0;
  double loss = 25.0;
  double lag = 20.0;
  std::int64_t steps = 300;

  static constexpr std::tuple kFields = {
      field("power", &Thermostat::power, "greatest power of the heater", positive, "W"),
      field("capacity", &Thermostat::capacity, "heat that warms the room by one degree", positive, "J/K"),
      field("loss", &Thermostat::loss, "power that is lost for each degree", positive, "W/K"),
      field("lag", &Thermostat::lag, "time constant of the sensor, at least a step", at_least(1.0), "s"),
      field("steps", &Thermostat::steps, "control steps in an episode", positive),
  };
};

class ThermostatLoop final : public Loop {
 public:
  ThermostatLoop(const Interface& spec, std::span<const Injection> injections, std::size_t lanes)
      : spec_(spec),
        disturber_(injections, {spec.steps, spec.control_rate}, lanes),
        actuator_(spec, Readings{}, lanes),
        counter_(lanes, 0),
        failed_(lanes, 0),
        reward_(lanes, 0.0),
        parameters_(spec.parameters.size(), lanes, 1.0),
        room_(1, lanes),
        sensor_(1, lanes),
        seen_(1, lanes) {}

  const Interface& spec() const override { return spec_; }
  std::size_t lanes() const override { return counter_.size(); }
  Rows<const double> observation() const override { return seen_.view(); }
  std::span<const std::int64_t> steps_done() const override { return counter_; }

  void begin(std::size_t lane, const EpisodeStart& start) override {
    disturber_.begin(lane, start);
    counter_[lane] = start.step;
    for (std::size_t i = 0; i < parameters_.rows(); ++i) parameters_.at(i, lane) = start.parameters[i];
    room_.at(0, lane) = sensor_.at(0, lane) = seen_.at(0, lane) = start.state[0];
    disturber_.apply(Site::kObservation, counter_[lane], seen_.view(), lane);
  }

  void step(Rows<const double> command) override {
    actuator_.act(command, counter_, disturber_);
    for (std::size_t lane = 0; lane < lanes(); ++lane) {
      const double capacity = parameters_.at(0, lane), loss = parameters_.at(1, lane), lag = parameters_.at(2, lane);
      double& room = room_.at(0, lane);
      room += (actuator_.applied().at(0, lane) - loss * room) / (capacity * spec_.control_rate);
      sensor_.at(0, lane) += (room - sensor_.at(0, lane)) * std::min(1.0, 1.0 / (lag * spec_.control_rate));
      const double error = (room - kGoal) / 2;
      reward_[lane] = gust::exp(-error * error);
      failed_[lane] = static_cast<std::uint8_t>(!(room >= 10 && room <= 30));  // NaN fails too
      ++counter_[lane];
    }
    std::ranges::copy(sensor_.row(0), seen_.row(0).begin());
    disturber_.apply(Site::kObservation, counter_, seen_.view(), {});
  }

  StepRecord record() const override {
    return {.reward = reward_,
            .failed = failed_,
            .not_finite_command = actuator_.not_finite(),
            .commanded = actuator_.commanded(),
            .disturbed = actuator_.disturbed(),
            .applied = actuator_.applied()};
  }

 private:
  const Interface& spec_;
  Disturber disturber_;
  Actuator actuator_;
  std::vector<std::int64_t> counter_;
  std::vector<std::uint8_t> failed_;
  std::vector<double> reward_;
  Matrix<double> parameters_, room_, sensor_, seen_;
};

class Thermostats final : public LoopSource {
 public:
  explicit Thermostats(const Thermostat& of) {
    spec_.observation = {{"temperature", "degC"}};  // and no state: nobody is told the temperature of the room
    spec_.action = {{"heat", "W"}};
    spec_.parameters = {{"capacity", "J/K", of.capacity}, {"loss", "W/K", of.loss}, {"lag", "s", of.lag}};
    spec_.control_rate = 1;
    spec_.steps = of.steps;
    spec_.normalized_action = true;
    spec_.action_scale = spec_.action_offset = {of.power / 2};
    spec_.action_low = {0};
    spec_.action_high = {of.power};
  }

  const Interface& spec() const override { return spec_; }
  std::vector<StartProtocol> starts() const override { return {{"nominal", false, {kGoal}}, random_starts()}; }
  std::vector<double> start_state(const StartProtocol& start, Rng episode) const override {
    if (!start.random) return start.state;
    return {kGoal - 2 + 4 * episode.split("start").uniform(0)};
  }
  std::unique_ptr<Loop> make(std::span<const Injection> injections, std::size_t lanes) const override {
    return std::make_unique<ThermostatLoop>(spec_, injections, lanes);
  }

 private:
  Interface spec_;
};

}  // namespace

Entry<LoopSource> loop_thermostat() {
  return make_entry<LoopSource, Thermostat>(
      "thermostat", "Room that a heater warms and a lagging sensor watches; hold it at 20 degrees.",
      "Newton's law of cooling", [](const Thermostat& options) { return std::make_unique<Thermostats>(options); });
}

}  // namespace gust
