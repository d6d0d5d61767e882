#include <benchmark/benchmark.h>

#include "bench/peak.h"
#include "gust/agents/agent.h"

// A whole training of PPO on the cart-pole: environments, networks, optimiser, learning curve. `of_peak` counts
// 0.52 MFLOP a step, whether or not a step of the actor was skipped.

using namespace gust;

namespace {

void ppo(benchmark::State& state) {
  const Made<Plant> plant = plants().make({{{"kind", Value{std::string("cartpole"), {}}}}, {}});
  const Made<Agent> agent =
      agents().make({{{"kind", Value{std::string("ppo"), {}}}, {"steps", Value{state.range(0), {}}}}, {}});
  double best = 1e300;
  double score = 0.0;
  for (auto _ : state) {
    best = std::min(best, bench::shortest(1, [&] {
                      const TrainingTask task{plant.object.get(), {}, {}, 1};
                      const std::unique_ptr<Training> training = agent->start(task);
                      while (!training->done()) training->advance();
                      score = training->curve().back().anr_h;
                    }));
  }
  const double steps = static_cast<double>(state.range(0));
  state.counters["seconds_per_1M"] = best * 1e6 / steps;
  state.counters["peak_GFLOPS"] = bench::peak() * 1e-9;
  state.counters["of_peak"] = 0.52e6 * steps / best / bench::peak();
  state.counters["return_over_250"] = score;
}

BENCHMARK(ppo)->Arg(100'000)->Arg(1'000'000)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
