#include "gust/nn/gaussian.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "gust/nn/pytorch_reference_test.h"

using namespace gust;

TEST_CASE("8.3.2 the density at the mean and the entropy have their closed forms") {
  const std::array<float, 4> mean = {0.3f, -1.0f, 2.0f, 0.0f};
  const std::array<float, 2> log_std = {-0.5f, -0.5f};
  std::array<float, 2> density;

  log_density<float>({mean, log_std}, mean, density);

  CHECK(std::abs(density[0] / 2 - -0.4189385) < 1e-7);
  CHECK(std::abs(density[1] / 2 - -0.4189385) < 1e-7);
  CHECK(std::abs(entropy<float>(log_std) / 2 - 0.9189385) < 1e-7);
}

TEST_CASE("densities and entropy agree with PyTorch") {
  auto reference = read_reference(GUST_TEST_DATA "/reference/nn/pytorch.txt");
  const auto& expected = reference["ppo.log_density"];
  std::vector<double> density(expected.size());

  log_density<double>({reference["ppo.mean"], reference["ppo.log_std"]}, reference["ppo.action"], density);

  for (std::size_t i = 0; i < expected.size(); ++i) CHECK(density[i] == doctest::Approx(expected[i]).epsilon(1e-8));
  CHECK(entropy<double>(reference["ppo.log_std"]) == doctest::Approx(reference["ppo.entropy"][0]).epsilon(1e-8));
}

TEST_CASE("8.1.1 finite differences confirm the gradient of the Gaussian's density") {
  const std::array<double, 3> weight = {0.7, -1.1, 0.4};  // of the densities in the loss
  const std::array<double, 6> action = {0.3, -0.2, 1.0, 0.9, -0.4, 0.1};
  std::array<double, 6> mean = {0.1, 0.2, 0.8, -0.5, 0.0, 0.6};
  std::array<double, 2> log_std = {-0.5, 0.2};
  const auto loss = [&] {
    std::array<double, 3> density;
    log_density<double>({mean, log_std}, action, density);
    return weight[0] * density[0] + weight[1] * density[1] + weight[2] * density[2];
  };
  const auto slope = [&](double& x) {
    const double h = 1e-5, at = x;
    x = at + h;
    const double above = loss();
    x = at - h;
    const double below = loss();
    x = at;
    return (above - below) / (2 * h);
  };
  std::array<double, 6> mean_gradient;
  std::array<double, 2> log_std_gradient = {};

  log_density_gradient<double>({mean, log_std}, action, weight, {mean_gradient, log_std_gradient});

  for (std::size_t i = 0; i < mean.size(); ++i)
    CHECK(slope(mean[i]) == doctest::Approx(mean_gradient[i]).epsilon(1e-6));
  for (std::size_t i = 0; i < 2; ++i) CHECK(slope(log_std[i]) == doctest::Approx(log_std_gradient[i]).epsilon(1e-6));
}
