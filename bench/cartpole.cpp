#include <benchmark/benchmark.h>

#include "bench/peak.h"
#include "gust/control/closed_loop.h"
#include "gust/core/rng.h"
#include "gust/sim/plant.h"

// The cart-pole in double through the closed loop: control steps with reward, failure and reset, one core.
// `steps_per_s` counts control steps of all lanes, from the shortest of many runs.

using namespace gust;

namespace {

Made<Plant> cartpole(double control_rate, double physics_rate) {
  const Place place{"bench"};
  return plants().make(Table{{{"kind", {std::string("cartpole"), place}},
                              {"control_rate", {control_rate, place}},
                              {"physics_rate", {physics_rate, place}}},
                             place});
}

/// Random forces, and a new random start whenever a lane fails or its time is up.
void closed_loop(benchmark::State& state, double control_rate, double physics_rate) {
  constexpr std::size_t kLanes = 256;
  constexpr int kSteps = 20;
  const Made<Plant> plant = cartpole(control_rate, physics_rate);
  const PlantSpec& spec = plant->spec();
  ClosedLoop loop(*plant, {}, {}, kLanes);
  Matrix<double> command(1, kLanes);
  for (std::size_t lane = 0; lane < kLanes; ++lane) command.at(0, lane) = Rng(1).normal(lane);
  EpisodeStart start{spec.start, nominal_parameters(spec), {}, nullptr};
  std::uint64_t episode = 0;
  const auto begin = [&](std::size_t lane) {
    const Rng rng(++episode);
    for (std::size_t i = 0; i < start.state.size(); ++i) start.state[i] = 0.1 * rng.uniform(i) - 0.05;
    loop.begin(lane, start);
  };
  for (std::size_t lane = 0; lane < kLanes; ++lane) begin(lane);

  double best = 1e300;
  for (auto _ : state) {
    best = std::min(best, bench::shortest(1, [&] {
                      for (int k = 0; k < kSteps; ++k) {
                        loop.step(command.view());
                        for (std::size_t lane = 0; lane < kLanes; ++lane) {
                          if (loop.failed(lane) || loop.steps_done(lane) == spec.steps) begin(lane);
                        }
                      }
                    }));
  }
  state.counters["steps_per_s"] = kSteps * kLanes / best;
  state.counters["peak_GFLOPS"] = bench::peak() * 1e-9;
}

}  // namespace

BENCHMARK_CAPTURE(closed_loop, cartpole_50_50_Hz, 50.0, 50.0);
BENCHMARK_CAPTURE(closed_loop, cartpole_50_1000_Hz, 50.0, 1000.0);
BENCHMARK_CAPTURE(closed_loop, cartpole_15_750_Hz, 15.0, 750.0);
