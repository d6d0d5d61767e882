#include <benchmark/benchmark.h>

#include "bench/peak.h"
#include "gust/control/closed_loop.h"
#include "gust/core/rng.h"
#include "gust/sim/plant.h"

// The plants in double through the closed loop: control steps with reward, failure and reset, one core.
// `steps_per_s` counts control steps of all lanes, from the shortest of many runs.

using namespace gust;

namespace {

Made<Plant> plant_at(const char* kind, double control_rate, double physics_rate) {
  const Place place{"bench"};
  return plants().make(Table{{{"kind", {std::string(kind), place}},
                              {"control_rate", {control_rate, place}},
                              {"physics_rate", {physics_rate, place}}},
                             place});
}

/// Random actions, and a new random start whenever a lane fails or its time is up.
void closed_loop(benchmark::State& state, const char* kind, double control_rate, double physics_rate) {
  constexpr std::size_t kLanes = 256;
  constexpr int kSteps = 20;
  const Made<Plant> plant = plant_at(kind, control_rate, physics_rate);
  const PlantSpec& spec = plant->spec();
  ClosedLoop loop(*plant, {}, {}, kLanes);
  Matrix<double> command(spec.action.size(), kLanes);
  for (std::size_t i = 0; i < command.rows(); ++i) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) command.at(i, lane) = Rng(1).normal(i * kLanes + lane);
  }
  EpisodeStart start{spec.start, nominal_parameters(spec), {}, nullptr};
  std::uint64_t episode = 0;
  const auto begin = [&](std::size_t lane) {
    const Rng rng(++episode);
    start.state = random_start(spec, rng);
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

BENCHMARK_CAPTURE(closed_loop, cartpole_50_50_Hz, "cartpole", 50.0, 50.0);
BENCHMARK_CAPTURE(closed_loop, cartpole_50_1000_Hz, "cartpole", 50.0, 1000.0);
BENCHMARK_CAPTURE(closed_loop, cartpole_15_750_Hz, "cartpole", 15.0, 750.0);
BENCHMARK_CAPTURE(closed_loop, quadrotor_50_1000_Hz, "quadrotor", 50.0, 1000.0);
