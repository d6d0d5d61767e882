#include "gust/nn/tiled_mlp.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/core/rng.h"
#include "gust/nn/initialise.h"

using namespace gust;

namespace {

template <class T>
struct Problem {
  Mlp<T> mlp;
  Tiles<T> input, at_output;
  std::vector<T> rows, at_output_rows;  // the same, the numbers of a lane side by side

  Problem(const MlpShape& shape, std::size_t lanes)
      : mlp(shape), input(lanes, shape.inputs()), at_output(lanes, shape.outputs()) {
    initialise_uniform(mlp, Rng(4));
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      for (std::size_t i = 0; i < shape.inputs(); ++i) {
        input.at(lane, i) = static_cast<T>(Rng(5).normal(rows.size()));
        rows.push_back(input.at(lane, i));
      }
      for (std::size_t i = 0; i < shape.outputs(); ++i) {
        at_output.at(lane, i) = static_cast<T>(Rng(6).normal(at_output_rows.size()));
        at_output_rows.push_back(at_output.at(lane, i));
      }
    }
  }
};

template <class T>
double relative_distance(std::span<const T> a, std::span<const T> b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(difference / size);
}

const std::vector<std::vector<std::size_t>> kSizes = {{5, 256, 256, 1}, {4, 32, 64, 2}, {6, 48, 20, 3}, {3, 8, 24, 1},
                                                      {7, 100, 2},      {3, 2},         {2, 40}};
constexpr Activation kAll[] = {Activation::kTanh, Activation::kRelu, Activation::kLeakyRelu};

}  // namespace

TEST_CASE("a batch in tiles gives the same outputs as one lane after the other, to the bit") {
  for (const Activation activation : kAll) {
    for (const auto& sizes : kSizes) {
      for (const std::size_t lanes : {1u, 64u, 150u}) {
        Problem<float> problem({sizes, activation, lanes == 150u}, lanes);
        MlpWorkspace<float> workspace(problem.mlp.shape(), lanes);
        TiledMlp<float> tiled(problem.mlp.shape(), lanes);

        const auto expected = workspace.forward(problem.mlp, problem.rows);
        const Tiles<float>& output = tiled.forward(problem.mlp, problem.input);

        bool equal = true;
        for (std::size_t lane = 0; lane < lanes; ++lane)
          for (std::size_t i = 0; i < sizes.back(); ++i)
            equal = equal && output.at(lane, i) == expected[lane * sizes.back() + i];
        CHECK((equal || sizes.back() <= 16));  // narrow outputs are added up in another order
        for (std::size_t lane = 0; lane < lanes; ++lane)
          CHECK(output.at(lane, 0) == doctest::Approx(expected[lane * sizes.back()]).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE_TEMPLATE("8.1.1 gradients in tiles are those of one lane after the other", T, float, double) {
  const double tolerance = sizeof(T) == sizeof(float) ? 1e-5 : 1e-12;
  for (const Activation activation : kAll) {
    for (const auto& sizes : kSizes) {
      for (const std::size_t lanes : {1u, 64u, 150u}) {
        Problem<T> problem({sizes, activation, lanes == 64u}, lanes);
        MlpWorkspace<T> workspace(problem.mlp.shape(), lanes);
        TiledMlp<T> tiled(problem.mlp.shape(), lanes);
        Buffer<T> expected(problem.mlp.parameters().size()), gradient(expected.size());

        workspace.forward(problem.mlp, problem.rows);
        workspace.backward(problem.mlp, problem.at_output_rows, expected);
        for (int twice = 0; twice < 2; ++twice) {  // it is written, not added
          tiled.forward(problem.mlp, problem.input);
          tiled.backward(problem.mlp, problem.at_output, gradient);
        }

        CHECK(relative_distance<T>(gradient, expected) < tolerance);
      }
    }
  }
}

TEST_CASE_TEMPLATE("8.1.1 the gradient at some of the inputs is that of one lane after the other", T, float, double) {
  const double tolerance = sizeof(T) == sizeof(float) ? 1e-5 : 1e-12;
  for (const auto& sizes : kSizes) {
    const std::size_t lanes = 100, inputs = sizes.front();
    Problem<T> problem({sizes, Activation::kRelu}, lanes);
    MlpWorkspace<T> workspace(problem.mlp.shape(), lanes);
    TiledMlp<T> tiled(problem.mlp.shape(), lanes, {.first = inputs - 2, .count = 2});
    std::vector<T> expected(lanes * inputs);

    workspace.forward(problem.mlp, problem.rows);
    workspace.backward_to_input(problem.mlp, problem.at_output_rows, expected);
    tiled.forward(problem.mlp, problem.input);
    const Tiles<T>& gradient = tiled.backward_to_input(problem.mlp, problem.at_output);

    std::vector<T> got, wanted;
    const std::size_t skipped = gradient.features() - 2;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      for (std::size_t i = 0; i < 2; ++i) {
        got.push_back(gradient.at(lane, skipped + i));
        wanted.push_back(expected[lane * inputs + inputs - 2 + i]);
      }
    }
    CHECK(relative_distance<T>(got, wanted) < tolerance);
  }
}
