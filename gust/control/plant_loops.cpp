#include "gust/control/plant_loops.h"

#include "gust/control/closed_loop.h"

namespace gust {

std::vector<double> PlantLoops::start_state(const StartProtocol& start, Rng episode) const {
  return start.random ? random_start(spec(), episode) : start.state;
}

std::string PlantLoops::start_complaint(const StartProtocol& start) const {
  const PlantSpec& of = spec();
  for (std::size_t i = 0; start.random && i < of.state.size(); ++i) {
    const double middle = of.start[i] + of.start_offset[i], range = of.start_range[i];
    if (middle + range >= of.fail_low[i] && middle - range <= of.fail_high[i]) continue;
    return fmt::format("random starts have {} = {:.4g} to {:.4g}, outside the safe set, {:.4g} to {:.4g} {}",
                       of.state[i].name, middle - range, middle + range, of.fail_low[i], of.fail_high[i],
                       of.state[i].unit);
  }
  for (std::size_t i = 0; i < start.state.size(); ++i) {
    if (start.state[i] >= of.fail_low[i] && start.state[i] <= of.fail_high[i]) continue;
    return fmt::format(
        "{} = {} lies outside the safe set, {:.4g} to {:.4g} {}: the episode would fail before its first step",
        of.state[i].name, start.state[i], of.fail_low[i], of.fail_high[i], of.state[i].unit);
  }
  return "";
}

std::unique_ptr<Loop> PlantLoops::make(std::span<const Injection> injections, std::size_t lanes) const {
  return std::make_unique<ClosedLoop>(*plant_, readings_, injections, lanes);
}

double PlantLoops::seconds_per_step() const { return kSecondsPerSubstep * spec().physics_rate / spec().control_rate; }

}  // namespace gust
