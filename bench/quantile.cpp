#include <benchmark/benchmark.h>

#include "bench/peak.h"
#include "gust/nn/quantile_network.h"

// The implicit quantile network of RAAC beside the core's peak. FLOP count multiplications and additions of the
// products as they are defined, lanes x fractions through the head, not as they are computed.

using namespace gust;

namespace {

constexpr QuantileShape kShape = {.inputs = 5};

double flop_forward(double lanes, double fractions) {
  const double hidden = static_cast<double>(kShape.hidden);
  const double head = static_cast<double>(kShape.head);
  const double trunk = hidden * (static_cast<double>(kShape.inputs) + hidden);
  return 2.0 * (lanes * trunk + lanes * fractions * (hidden * head + head) +
                fractions * hidden * static_cast<double>(kShape.cosines));
}

enum class Pass { kForward, kBackward, kToInput };

void quantile_network(benchmark::State& state, Pass pass) {
  const auto lanes = static_cast<std::size_t>(state.range(0));
  const auto count = static_cast<std::size_t>(state.range(1));
  QuantileNetwork<float> network(kShape), gradient(kShape);
  initialise_uniform(network, Rng(1));
  QuantileRunner<float> runner(kShape, {lanes, count}, {4, 1});
  Tiles<float> x(lanes, kShape.inputs), at_z(lanes, count);
  Buffer<float> fractions(count);
  for (std::size_t i = 0; i < count; ++i) fractions[i] = static_cast<float>(Rng(3).uniform(i));
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    for (std::size_t i = 0; i < kShape.inputs; ++i) x.at(lane, i) = static_cast<float>(Rng(2).split(lane).normal(i));
    for (std::size_t i = 0; i < count; ++i) at_z.at(lane, i) = static_cast<float>(1e-6 * Rng(4).split(lane).normal(i));
  }
  double best = 1e300;
  for (auto _ : state) {
    best = std::min(best, bench::shortest(1, [&] {
                            for (int call = 0; call < 2; ++call) {
                              runner.forward(network, x, {.shared = fractions});
                              if (pass == Pass::kBackward) runner.backward(network, at_z, gradient);
                              if (pass == Pass::kToInput) runner.backward_to_input(network, at_z);
                            }
                          }) / 2);
  }
  const double passes = pass == Pass::kForward ? 1.0 : pass == Pass::kBackward ? 3.0 : 2.0;
  const double flop = passes * flop_forward(static_cast<double>(lanes), static_cast<double>(count));
  state.counters["us"] = best * 1e6;
  state.counters["MFLOP"] = flop * 1e-6;
  state.counters["peak_GFLOPS"] = bench::peak() * 1e-9;
  state.counters["of_peak"] = flop / best / bench::peak();
}

BENCHMARK_CAPTURE(quantile_network, forward, Pass::kForward)->Args({64, 32});
BENCHMARK_CAPTURE(quantile_network, forward_backward, Pass::kBackward)->Args({64, 32});
BENCHMARK_CAPTURE(quantile_network, to_input, Pass::kToInput)->Args({64, 8});

}  // namespace
