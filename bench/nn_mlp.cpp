#include <benchmark/benchmark.h>

#include "bench/peak.h"
#include "gust/nn/adam.h"
#include "gust/nn/initialise.h"

// Networks beside the core's peak. `of_peak` is the share of the FMA peak, from the shortest of many short runs, so
// that a busy machine does not spoil it. FLOP count multiplications and additions of the products, nothing else.

using namespace gust;

namespace {

/// Multiply-adds of all layers per lane.
double weights_of(const MlpShape& shape) {
  double sum = 0;
  for (std::size_t layer = 0; layer < shape.layers(); ++layer)
    sum += static_cast<double>(shape.sizes[layer] * shape.sizes[layer + 1]);
  return sum;
}

struct Problem {
  Mlp<float> mlp;
  MlpWorkspace<float> workspace;
  Buffer<float> x, dy, gradient;
  AdamState<float> adam;

  Problem(const MlpShape& shape, std::size_t lanes)
      : mlp(shape),
        workspace(shape, lanes),
        x(lanes * shape.inputs()),
        dy(lanes * shape.outputs()),
        gradient(mlp.parameters().size()),
        adam(gradient.size()) {
    initialise_uniform(mlp, Rng(1));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<float>(Rng(2).normal(i));
    for (std::size_t i = 0; i < dy.size(); ++i) dy[i] = static_cast<float>(1e-6 * Rng(3).normal(i));
  }
};

/// Reports the shortest time of 20 calls against FLOP a call.
template <class F>
void report(benchmark::State& state, double flop, F&& f) {
  double best = 1e300;
  for (auto _ : state) {
    best = std::min(best, bench::shortest(1, [&] {
                            for (int call = 0; call < 20; ++call) f();
                          }) / 20);
  }
  state.counters["us"] = best * 1e6;
  if (flop > 0) {
    state.counters["GFLOPS"] = flop / best * 1e-9;
    state.counters["peak_GFLOPS"] = bench::peak() * 1e-9;
    state.counters["of_peak"] = flop / best / bench::peak();
  }
}

void forward(benchmark::State& state, const MlpShape& shape) {
  const auto lanes = static_cast<std::size_t>(state.range(0));
  Problem p(shape, lanes);
  report(state, 2.0 * static_cast<double>(lanes) * weights_of(shape),
         [&] { benchmark::DoNotOptimize(p.workspace.forward(p.mlp, p.x).data()); });
}

void forward_backward(benchmark::State& state, const MlpShape& shape) {
  const auto lanes = static_cast<std::size_t>(state.range(0));
  Problem p(shape, lanes);
  const double unused = static_cast<double>(shape.sizes[0] * shape.sizes[1]);  // no gradient at the inputs
  report(state, 2.0 * static_cast<double>(lanes) * (3.0 * weights_of(shape) - unused), [&] {
    p.workspace.forward(p.mlp, p.x);
    p.workspace.backward(p.mlp, p.dy, p.gradient);
  });
}

void adam(benchmark::State& state, const MlpShape& shape) {
  Problem p(shape, 1);
  report(state, 0.0, [&] { adam_step<float>({}, p.adam, p.mlp.parameters(), p.gradient); });
}

void products(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const Product<float> product({.m = size, .n = 64, .k = size});
  Buffer<float> a(size * size), b(size * 64), c(size * 64);
  report(state, 2.0 * 64 * size * size, [&] { product(a.data(), b.data(), c.data()); });
}

const MlpShape kPpo = {{4, 64, 64, 1}};
const MlpShape kSac = {{5, 256, 256, 1}, Activation::kRelu};

BENCHMARK(products)->Arg(64)->Arg(256);
BENCHMARK_CAPTURE(forward, 4_64_64_1_tanh, kPpo)->Arg(4)->Arg(64)->Arg(400);
BENCHMARK_CAPTURE(forward_backward, 4_64_64_1_tanh, kPpo)->Arg(64);
BENCHMARK_CAPTURE(forward_backward, 5_256_256_1_relu, kSac)->Arg(64);
BENCHMARK_CAPTURE(adam, 4_64_64_1, kPpo);

}  // namespace
