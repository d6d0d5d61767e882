#include "gust/nn/wide_mlp.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "gust/core/rng.h"

namespace gust {
namespace {

Mlp<float> random_mlp(const MlpShape& shape, std::uint64_t seed) {
  Mlp<float> mlp(shape);
  for (std::size_t i = 0; i < mlp.parameters().size(); ++i) {
    mlp.parameters()[i] = static_cast<float>(0.3 * Rng(seed).normal(i));
  }
  return mlp;
}

std::vector<double> draws(std::size_t count, std::uint64_t seed) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = Rng(seed).normal(i);
  return values;
}

double apply(Activation kind, double z) {
  if (kind == Activation::kTanh) return std::tanh(z);
  if (kind == Activation::kRelu) return std::max(z, 0.0);
  if (kind == Activation::kIdentity) return z;
  return z > 0 ? z : 0.01 * z;
}

/// The network as its definition reads, layer by layer, in long double.
std::vector<double> by_definition(const Mlp<float>& mlp, const double* in) {
  const MlpShape& shape = mlp.shape();
  std::vector<double> x(in, in + shape.inputs());
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    std::vector<double> y(shape.sizes[layer + 1]);
    for (std::size_t j = 0; j < y.size(); ++j) {
      long double sum = mlp.bias(layer, j);
      for (std::size_t i = 0; i < x.size(); ++i) sum += static_cast<long double>(mlp.weight(layer, j, i)) * x[i];
      const auto z = static_cast<double>(sum);
      y[j] = apply(shape.after(layer), z);
    }
    x = y;
  }
  return x;
}

TEST_CASE("a network in double gives what its definition says, for any widths and numbers of lanes") {
  for (const Activation kind : {Activation::kTanh, Activation::kRelu, Activation::kLeakyRelu}) {
    for (const std::vector<std::size_t>& sizes :
         {std::vector<std::size_t>{4, 64, 64, 1}, {3, 17, 2}, {5, 1}, {1, 21, 6}}) {
      const bool linear_top = sizes.front() == 3;
      const Mlp<float> mlp = random_mlp({sizes, kind, linear_top}, sizes.size());
      for (const std::size_t lanes : {1, 2, 3, 8, 25}) {
        WideMlp wide(mlp, 25);
        const std::vector<double> in = draws(lanes * wide.inputs(), 7);
        const std::span<const double> out = wide.forward(in);

        REQUIRE(out.size() == lanes * wide.outputs());
        double worst = 0;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          const std::vector<double> truth = by_definition(mlp, &in[lane * wide.inputs()]);
          for (std::size_t j = 0; j < truth.size(); ++j) {
            worst = std::max(worst, std::abs(out[lane * wide.outputs() + j] - truth[j]));
          }
        }
        CHECK(worst < 1e-8);  // 64 weights of about 0.3 times tanh within 2e-10, twice
      }
    }
  }
}

TEST_CASE("a network in double has bits that do not depend on the lanes beside") {
  WideMlp wide(random_mlp({.sizes = {4, 64, 64, 2}}, 3), 70);
  const std::vector<double> in = draws(70 * 4, 9);
  const std::span<const double> together = wide.forward(in);
  const std::vector<double> all(together.begin(), together.end());

  bool equal = true;
  for (std::size_t lane = 0; lane < 70; ++lane) {
    const std::span<const double> alone = wide.forward(std::span(in).subspan(4 * lane, 4));
    equal = equal && alone[0] == all[2 * lane] && alone[1] == all[2 * lane + 1];
  }

  CHECK(equal);
}

TEST_CASE("tanh in double is within 2e-10, exact at zero and at the ends, and keeps NaN") {
  Mlp<float> mlp({.sizes = {1, 1, 1}});
  mlp.weight(0, 0, 0) = 1.0f;
  mlp.weight(1, 0, 0) = 1.0f;
  WideMlp wide(mlp, 1);
  const auto tanh_of = [&](double x) { return wide.forward(std::span(&x, 1)).front(); };

  double worst = 0;
  for (double x = -21; x < 21; x += 0.00137) worst = std::max(worst, std::abs(tanh_of(x) - std::tanh(x)));

  CHECK(worst < 2e-10);
  CHECK(tanh_of(0.0) == 0.0);
  CHECK(tanh_of(1e300) == 1.0);
  CHECK(tanh_of(-std::numeric_limits<double>::infinity()) == -1.0);
  CHECK(std::isnan(tanh_of(std::numeric_limits<double>::quiet_NaN())));
  CHECK(std::abs(tanh_of(1e-9) / 1e-9 - 1) < 1e-9);  // small ones keep their digits
}

}  // namespace
}  // namespace gust
