#include "gust/agents/ppo_loss.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "gust/core/rng.h"
#include "gust/nn/gaussian.h"
#include "gust/nn/initialise.h"
#include "gust/nn/pytorch_reference_test.h"

using namespace gust;

namespace {

/// Gradient at the log density of one sample with this advantage and ratio.
double gradient_at(double advantage, double ratio) {
  const std::array<double, 1> now = {std::log(ratio)}, old = {0.0}, a = {advantage};
  std::array<double, 1> gradient;
  policy_loss<double>({now, old, a}, 0.2, gradient);
  return gradient[0];
}

/// An actor on drawn samples; its whole loss as PPO takes it, with the entropy's share.
struct ActorProblem {
  Mlp<double> mlp{{{5, 7, 6, 3}}};
  std::array<double, 3> log_std = {-0.5, -0.3, 0.1};
  std::vector<double> observation, action, old, advantage;
  MlpWorkspace<double> workspace{mlp.shape(), 8};

  ActorProblem() {
    initialise_uniform(mlp, Rng(2));
    for (std::size_t i = 0; i < 8 * 5; ++i) observation.push_back(Rng(3).normal(i));
    for (std::size_t i = 0; i < 8 * 3; ++i) action.push_back(0.5 * Rng(4).normal(i));
    old = densities();
    for (std::size_t i = 0; i < 8; ++i) {
      old[i] += 0.3 * Rng(5).normal(i);
      advantage.push_back(Rng(6).normal(i));
    }
  }
  std::vector<double> densities() {
    std::vector<double> density(8);
    log_density<double>({workspace.forward(mlp, observation), log_std}, action, density);
    return density;
  }
  double loss() {
    const auto density = densities();
    std::vector<double> unused(8);
    return policy_loss<double>({density, old, advantage}, 0.2, unused).loss - 0.01 * entropy<double>(log_std);
  }
  double slope(double& x) {
    const double h = 1e-5, at = x;
    x = at + h;
    const double above = loss();
    x = at - h;
    const double below = loss();
    x = at;
    return (above - below) / (2 * h);
  }
};

}  // namespace

TEST_CASE("8.3.3 the clip stops the gradient where the ratio has gone far enough, and only there") {
  CHECK(gradient_at(1.0, 1.3) == 0.0);
  CHECK(gradient_at(-1.0, 1.3) == doctest::Approx(1.3));
  CHECK(gradient_at(-1.0, 0.7) == 0.0);
  CHECK(gradient_at(1.0, 0.7) == doctest::Approx(-0.7));
  CHECK(gradient_at(1.0, 1.1) == doctest::Approx(-1.1));
}

TEST_CASE("8.1.1 finite differences confirm the gradient of PPO's policy loss through the network") {
  ActorProblem problem;
  const auto agrees = [](double slope, double expected) {
    return std::abs(slope - expected) <= 1e-6 * std::max(std::abs(expected), 1e-3);
  };

  const auto density = problem.densities();
  std::vector<double> at_density(8), at_mean(8 * 3);
  std::array<double, 3> at_log_std = {};
  policy_loss<double>({density, problem.old, problem.advantage}, 0.2, at_density);
  const auto mean = problem.workspace.forward(problem.mlp, problem.observation);
  log_density_gradient<double>({mean, problem.log_std}, problem.action, at_density, {at_mean, at_log_std});
  Buffer<double> gradient(problem.mlp.parameters().size());
  problem.workspace.backward(problem.mlp, at_mean, gradient);

  for_each_parameter(problem.mlp,
                     [&](std::size_t i) { CHECK(agrees(problem.slope(problem.mlp.parameters()[i]), gradient[i])); });
  for (std::size_t d = 0; d < 3; ++d) CHECK(agrees(problem.slope(problem.log_std[d]), at_log_std[d] - 0.01));
}

TEST_CASE("8.1.1 finite differences confirm the gradient of the value loss, clipped or not") {
  const std::array<double, 4> target = {1.0, -0.5, 0.2, 2.0}, old = {0.5, 0.0, 0.7, -1.0};
  std::array<double, 4> value = {0.9, 0.1, -0.4, -0.95};
  for (const double clip : {0.0, 0.2}) {
    std::array<double, 4> gradient, unused;
    value_loss<double>({value, target, old}, clip, gradient);
    for (std::size_t i = 0; i < value.size(); ++i) {
      const double at = value[i], h = 1e-5;
      value[i] = at + h;
      const double above = value_loss<double>({value, target, old}, clip, unused);
      value[i] = at - h;
      const double below = value_loss<double>({value, target, old}, clip, unused);
      value[i] = at;
      CHECK((above - below) / (2 * h) == doctest::Approx(gradient[i]).epsilon(1e-6));
    }
  }
}

TEST_CASE("losses and their gradients agree with PyTorch") {
  auto reference = read_reference(GUST_TEST_DATA "/reference/nn/pytorch.txt");
  const auto r = [&](const char* key) -> const std::vector<double>& { return reference.at(cat("ppo.", key)); };
  const auto agree = [](std::span<const double> values, const std::vector<double>& expected) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::abs(values[i] - expected[i]) > 2e-8) return false;  // the file has nine digits
    }
    return values.size() == expected.size();
  };
  std::vector<double> at_density(24), at_mean(48), at_log_std(2), at_value(24);

  const PolicyLoss policy = policy_loss<double>({r("log_density"), r("old"), r("advantage")}, 0.2, at_density);
  log_density_gradient<double>({r("mean"), r("log_std")}, r("action"), at_density, {at_mean, at_log_std});
  for (double& slope : at_log_std) slope -= 0.01;

  CHECK(policy.loss == doctest::Approx(r("policy_loss")[0]).epsilon(1e-7));
  CHECK(policy.kl == doctest::Approx(r("kl")[0]).epsilon(1e-6));
  CHECK(agree(at_mean, r("mean_gradient")));
  CHECK(agree(at_log_std, r("log_std_gradient")));
  CHECK(value_loss<double>({r("value"), r("returns"), r("old_value")}, 0.0, at_value) ==
        doctest::Approx(r("value_loss")[0]).epsilon(1e-7));
  CHECK(agree(at_value, r("value_gradient")));
  CHECK(value_loss<double>({r("value"), r("returns"), r("old_value")}, 0.2, at_value) ==
        doctest::Approx(r("clipped_value_loss")[0]).epsilon(1e-7));
  CHECK(agree(at_value, r("clipped_value_gradient")));
}
