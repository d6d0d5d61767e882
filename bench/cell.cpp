#include <benchmark/benchmark.h>

#include "bench/peak.h"
#include "gust/control/plant_loops.h"
#include "gust/eval/evaluate.h"
#include "gust/eval/metric.h"
#include "gust/nn/initialise.h"
#include "gust/study/policies/network_policy.h"

// One cell of a study: 25 episodes of 250 steps of a 64x64 tanh policy under white noise on the dynamics, with every
// metric; one core. `ms` is the shortest of many runs.

using namespace gust;

namespace {

void cell(benchmark::State& state, double physics_rate) {
  const Place place{"bench"};
  const Made<Plant> plant = plants().make(
      Table{{{"kind", {std::string("cartpole"), place}}, {"physics_rate", {physics_rate, place}}}, place});
  std::vector<Injection> injections;
  injections.push_back(read_injection(
      Table{{{"site", {std::string("dynamics"), place}}, {"waveform", {std::string("white"), place}}}, place},
      plant->spec()));
  const PlantLoops loops(plant.object, {});
  Evaluation evaluation;
  evaluation.source = &loops;
  evaluation.injections = injections;
  evaluation.cells = {{{0.2}, nominal_parameters(plant->spec())}};
  evaluation.starts = {random_starts()};
  Mlp<float> mlp({{4, 64, 64, 1}, Activation::kTanh});
  initialise_uniform(mlp, Rng(1));
  const auto policy = network_policy(read_onnx(write_onnx({mlp}, {}), "bench"));
  const MetricSet metrics;

  double best = 1e300;
  double sum = 0;
  for (auto _ : state) {
    best = std::min(best, bench::shortest(1, [&] {
                      evaluate(evaluation, *policy, [&](const EpisodeIndex&, const Episode& episode) {
                        for (std::size_t m = 0; m < metrics.size(); ++m) sum += metrics[m].value(episode);
                      });
                    }));
  }
  benchmark::DoNotOptimize(sum);
  state.counters["ms"] = best * 1e3;
  state.counters["peak_GFLOPS"] = bench::peak() * 1e-9;
}

}  // namespace

BENCHMARK_CAPTURE(cell, physics_50_Hz, 50.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cell, physics_1000_Hz, 1000.0)->Unit(benchmark::kMillisecond);
