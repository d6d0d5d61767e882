#include <benchmark/benchmark.h>
#include <time.h>

#include "bench/peak.h"
#include "gust/agents/agent.h"

// SAC, WCPG and RAAC on the cart-pole with networks of 256 x 256: one update with everything that belongs to it
// (environment steps, memory, networks, optimisers), from the shortest of many bursts of 20. `of_peak` counts the MFLOP
// that each line names (docs/algorithms.md 9); RAAC has two critics and 32 x 32 fractions.

using namespace gust;

namespace {

/// The processor's time of this thread [s]: what others do on the machine meanwhile does not count.
double thread_time() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void updates(benchmark::State& state, const char* kind, std::int64_t batch, double flop) {
  const Made<Plant> plant = plants().make({{{"kind", Value{std::string("cartpole"), {}}}}, {}});
  const Made<Agent> agent = agents().make(
      {{{"kind", {std::string(kind), {}}}, {"batch", {batch, {}}}, {"burst", {std::int64_t{20}, {}}}}, {}});
  const std::unique_ptr<Training> training = agent->start({plant.object.get(), {}, {}, 1});
  const int bursts = bench::once() ? 1 : 100;
  training->advance();  // the warm-up and the first burst
  double best = 1e300;
  for (auto _ : state) {
    for (int burst = 0; burst < bursts; ++burst) {
      const std::int64_t before = training->steps();
      const double start = thread_time();
      training->advance();
      best = std::min(best, (thread_time() - start) / static_cast<double>(training->steps() - before));
    }
  }
  state.counters["ms_per_update"] = best * 1e3;
  state.counters["peak_GFLOPS"] = bench::peak() * 1e-9;
  state.counters["of_peak"] = flop / best / bench::peak();
}

BENCHMARK_CAPTURE(updates, sac_64, "sac", 64, 137e6)->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(updates, sac_256, "sac", 256, 546e6)->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(updates, wcpg_64, "wcpg", 64, 138e6)->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(updates, raac_64, "raac", 64, 446e6)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
