#include <benchmark/benchmark.h>
#include <time.h>

#include "bench/peak.h"
#include "gust/agents/agent.h"

// SAC on the cart-pole with networks of 256 x 256: one update with everything that belongs to it (environment steps,
// memory, networks, optimisers), from the shortest of many bursts of 20. `of_peak` counts 137 MFLOP an update at batch
// 64, in proportion for others (spec: algorithms 10).

using namespace gust;

namespace {

constexpr int kBursts = 100;

/// The processor's time of this thread [s]: what others do on the machine meanwhile does not count.
double thread_time() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void sac(benchmark::State& state) {
  const auto batch = state.range(0);
  const Made<Plant> plant = plants().make({{{"kind", Value{std::string("cartpole"), {}}}}, {}});
  const Table options{{{"kind", {std::string("sac"), {}}}, {"batch", {batch, {}}}, {"burst", {std::int64_t{20}, {}}}},
                      {}};
  const Made<Agent> agent = agents().make(options);
  const std::unique_ptr<Training> training = agent->start({plant.object.get(), {}, {}, 1});
  training->advance();  // the warm-up and the first burst
  double best = 1e300;
  for (auto _ : state) {
    for (int burst = 0; burst < kBursts; ++burst) {
      const std::int64_t before = training->steps();
      const double start = thread_time();
      training->advance();
      best = std::min(best, (thread_time() - start) / static_cast<double>(training->steps() - before));
    }
  }
  const double flop = batch == 256 ? 546e6 : 137e6 * static_cast<double>(batch) / 64.0;
  state.counters["ms_per_update"] = best * 1e3;
  state.counters["peak_GFLOPS"] = bench::peak() * 1e-9;
  state.counters["of_peak"] = flop / best / bench::peak();
}

BENCHMARK(sac)->Arg(64)->Arg(256)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
