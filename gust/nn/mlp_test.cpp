#include "gust/nn/mlp.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/core/rng.h"
#include "gust/nn/adam.h"
#include "gust/nn/initialise.h"
#include "gust/nn/pytorch_reference_test.h"

using namespace gust;

namespace {

template <class T>
std::vector<T> draws(std::size_t count, Rng rng) {
  std::vector<T> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<T>(rng.normal(i));
  return values;
}

/// Half the mean square of the outputs' distance from `target`, and what follows from it.
template <class T>
struct Regression {
  Mlp<T> mlp;
  std::vector<T> input;
  std::vector<T> target;
  MlpWorkspace<T> workspace;

  Regression(Mlp<T> network, std::vector<T> x, std::vector<T> t)
      : mlp(std::move(network)), input(std::move(x)), target(std::move(t)), workspace(mlp.shape(), input.size()) {}

  std::vector<T> output() {
    const auto y = workspace.forward(mlp, input);
    return {y.begin(), y.end()};
  }
  double loss() {
    double sum = 0.0;
    const auto y = output();
    for (std::size_t i = 0; i < y.size(); ++i) sum += 0.5 * (y[i] - target[i]) * (y[i] - target[i]);
    return sum / static_cast<double>(y.size());
  }
  std::vector<T> output_gradient() {
    auto y = output();
    const T count = static_cast<T>(y.size());
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = (y[i] - target[i]) / count;
    return y;
  }
  Buffer<T> gradient() {
    const auto dy = output_gradient();
    Buffer<T> sum(mlp.parameters().size());
    workspace.backward(mlp, dy, sum);
    return sum;
  }
  std::vector<T> input_gradient() {
    const auto dy = output_gradient();
    std::vector<T> dx(input.size());
    workspace.backward_to_input(mlp, dy, dx);
    return dx;
  }
  double slope(T& x) {
    const double h = 1e-5, at = x;
    x = at + h;
    const double above = loss();
    x = at - h;
    const double below = loss();
    x = at;
    return (above - below) / (2 * h);
  }
};

template <class T>
Regression<T> drawn_regression(const MlpShape& shape, std::size_t lanes, std::uint64_t seed) {
  Mlp<double> mlp(shape);
  initialise_uniform(mlp, Rng(seed));
  const auto x = draws<double>(lanes * shape.inputs(), Rng(seed).split("x"));
  const auto t = draws<double>(lanes * shape.outputs(), Rng(seed).split("t"));
  return {converted<T>(mlp), {x.begin(), x.end()}, {t.begin(), t.end()}};
}

double relative_distance(std::span<const float> a, std::span<const double> b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(difference / size);
}

const MlpShape kSmall = {{5, 7, 6, 3}};
constexpr Activation kAll[] = {Activation::kTanh, Activation::kRelu, Activation::kLeakyRelu};

}  // namespace

TEST_CASE("8.1.1 finite differences confirm every parameter's gradient and the inputs'") {
  std::vector<MlpShape> shapes = {{kSmall.sizes, Activation::kTanh, true}, {{5, 7, 6, 1}, Activation::kTanh, true}};
  for (const Activation activation : kAll) shapes.push_back({kSmall.sizes, activation});
  for (const MlpShape& shape : shapes) {
    auto problem = drawn_regression<double>(shape, 4, 21);  // no sum lies within 1e-4 of zero

    const auto gradient = problem.gradient();
    const auto input_gradient = problem.input_gradient();

    const auto agrees = [](double slope, double expected) {
      return std::abs(slope - expected) <= 1e-6 * std::max(std::abs(expected), 1e-3);  // below: rounding of the loss
    };
    for_each_parameter(problem.mlp, [&](std::size_t i) {
      CAPTURE(i);
      CHECK(agrees(problem.slope(problem.mlp.parameters()[i]), gradient[i]));
    });
    for (std::size_t i = 0; i < problem.input.size(); ++i)
      CHECK(agrees(problem.slope(problem.input[i]), input_gradient[i]));
  }
}

TEST_CASE("a network whose last hidden layer is linear is the one without that layer") {
  for (const auto& sizes : {std::vector<std::size_t>{4, 256, 256, 1}, {5, 7, 6, 9, 3}, {4, 8, 2}}) {
    auto whole = drawn_regression<float>({sizes, Activation::kRelu, true}, 20, 8);
    const Mlp<float> joined = without_linear_top(whole.mlp);
    MlpWorkspace<float> workspace(joined.shape(), 20);

    const auto expected = whole.output();
    const auto output = workspace.forward(joined, whole.input);

    CHECK(joined.shape().layers() == sizes.size() - 2);
    CHECK_FALSE(joined.shape().linear_top);
    for (std::size_t i = 0; i < expected.size(); ++i) CHECK(std::abs(output[i] - expected[i]) < 1e-6);
    CHECK(without_linear_top(joined).shape() == joined.shape());
  }
}

TEST_CASE("8.1.1 gradients in float agree with those in double") {
  for (const Activation activation : kAll) {
    for (const auto& sizes : {kSmall.sizes, std::vector<std::size_t>{4, 64, 64, 1}, {12, 100, 40, 2}}) {
      auto single = drawn_regression<float>({sizes, activation}, 70, 3);
      auto twice = drawn_regression<double>({sizes, activation}, 70, 3);

      CHECK(relative_distance(single.gradient(), twice.gradient()) < 1e-4);
      CHECK(relative_distance(single.input_gradient(), twice.input_gradient()) < 1e-4);
    }
  }
}

TEST_CASE("outputs, gradients and ten steps of Adam agree with PyTorch") {
  auto reference = read_reference(GUST_TEST_DATA "/reference/nn/pytorch.txt");
  const std::pair<const char*, Activation> cases[] = {{"small_tanh", Activation::kTanh},
                                                      {"small_relu", Activation::kRelu},
                                                      {"small_leaky_relu", Activation::kLeakyRelu},
                                                      {"wide_tanh", Activation::kTanh}};
  for (const auto& [name, activation] : cases) {
    CAPTURE(name);
    const auto expected = [&](const char* key) { return reference.at(cat(name, ".", key)); };
    const auto sizes = expected("sizes");
    Mlp<double> mlp({{sizes.begin(), sizes.end()}, activation});
    std::size_t at = 0;
    for_each_parameter(mlp, [&](std::size_t i) { mlp.parameters()[i] = expected("parameters")[at++]; });
    Regression<double> problem(mlp, expected("input"), expected("target"));
    const auto agree = [&](std::span<const double> buffer, const char* key) {
      std::size_t next = 0;
      bool close = true;
      const auto values = expected(key);
      for_each_parameter(problem.mlp,
                         [&](std::size_t i) { close = close && std::abs(buffer[i] - values[next++]) < 2e-8; });
      return close;  // the file has nine digits
    };

    for (std::size_t i = 0; i < problem.output().size(); ++i)
      CHECK(std::abs(problem.output()[i] - expected("output")[i]) < 2e-8);
    CHECK(agree(problem.gradient(), "gradient"));
    for (std::size_t i = 0; i < problem.input.size(); ++i)
      CHECK(std::abs(problem.input_gradient()[i] - expected("input_gradient")[i]) < 2e-8);

    AdamState<double> adam(problem.mlp.parameters().size());
    for (int step = 0; step < 10; ++step) {
      auto gradient = problem.gradient();
      adam_step<double>({.rate = 1e-2}, adam, problem.mlp.parameters(), gradient);
    }
    CHECK(agree(problem.mlp.parameters(), "after_adam"));
  }
}

TEST_CASE("8.1.5 a lane's outputs are the same bits in a batch of any size") {
  for (const auto& sizes : {std::vector<std::size_t>{4, 64, 64, 1}, {5, 7, 6, 3}, {12, 100, 256, 2}, {6, 72, 20, 17}}) {
    auto all = drawn_regression<float>({sizes}, 151, 5);
    const auto together = all.output();
    for (const std::size_t lanes : {1, 2, 5, 16, 63, 64, 65, 149}) {
      MlpWorkspace<float> workspace(all.mlp.shape(), lanes);
      for (std::size_t first = 0; first + lanes <= 151; first += lanes) {
        const std::span<const float> part(&all.input[first * sizes.front()], lanes * sizes.front());
        const auto alone = workspace.forward(all.mlp, part);
        CHECK(std::equal(alone.begin(), alone.end(), together.begin() + first * sizes.back()));
      }
    }
  }
}

TEST_CASE("8.1.5 a gradient over a batch is the sum of its parts, lane after lane, to the bit") {
  auto all = drawn_regression<float>({{4, 64, 32, 1}}, 130, 6);
  const auto dy = all.output_gradient();
  Buffer<float> together(all.mlp.parameters().size());
  all.workspace.backward(all.mlp, dy, together);

  Buffer<float> parts(together.size());
  for (std::size_t lane = 0; lane < 130; ++lane) {
    all.workspace.forward(all.mlp, std::span<const float>(&all.input[4 * lane], 4));
    all.workspace.backward(all.mlp, std::span(dy).subspan(lane, 1), parts);
  }

  CHECK(parts == together);
}
