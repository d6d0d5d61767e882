#include <benchmark/benchmark.h>

#include "bench/peak.h"
#include "gust/agents/agent.h"

// A whole training of PPO, RARL or RAP on the cart-pole: environments, networks, optimiser, learning curve. `of_peak`
// counts 0.52 MFLOP a step that a side learns from, whether or not a step of the actor was skipped. Of PPO's and RARL's
// steps one side learns, of RAP's both: `us_per_minibatch` is the time over the minibatches of all sides together.

using namespace gust;

namespace {

constexpr double kMinibatchesPerStep = 60.0 / 400;

void train(benchmark::State& state, const char* kind, double minibatches) {
  const Made<Plant> plant = plants().make({{{"kind", Value{std::string("cartpole"), {}}}}, {}});
  const std::int64_t length = bench::once() ? std::int64_t{2000} : state.range(0);
  const Made<Agent> agent = agents().make({{{"kind", Value{std::string(kind), {}}}, {"steps", Value{length, {}}}}, {}});
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
  const double steps = static_cast<double>(length);
  state.counters["seconds_per_1M"] = best * 1e6 / steps;
  state.counters["us_per_minibatch"] = best * 1e6 / (minibatches * steps);
  state.counters["peak_GFLOPS"] = bench::peak() * 1e-9;
  state.counters["of_peak"] = 0.52e6 * steps * minibatches / kMinibatchesPerStep / best / bench::peak();
  state.counters["return_over_250"] = score;
}

// Two adversaries own 0 to 4 of the 4 environments each, for 0, 1, 3, 4 or 6 minibatches an epoch: 5.5 together.
constexpr double kOfAdversaries = 10.0 * (2 * 6 + 8 * (1 + 4) + 6 * (3 + 3)) / 16 / 400;

void ppo(benchmark::State& state) { train(state, "ppo", kMinibatchesPerStep); }
void rarl(benchmark::State& state) { train(state, "rarl", kMinibatchesPerStep); }
void rap(benchmark::State& state) { train(state, "rap", kMinibatchesPerStep + kOfAdversaries); }

BENCHMARK(ppo)->Arg(100'000)->Arg(1'000'000)->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK(rarl)->Arg(1'000'000)->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK(rap)->Arg(1'000'000)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
