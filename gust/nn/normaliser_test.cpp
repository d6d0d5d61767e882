#include "gust/nn/normaliser.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "gust/core/rng.h"

using namespace gust;

TEST_CASE("8.1.4 running moments equal those of two passes over all data once the prior is removed") {
  RunningMoments moments(1);
  std::vector<double> all;
  Matrix<double> batch(1, 4);

  for (std::uint64_t step = 0; step < 1000; ++step) {
    for (std::size_t lane = 0; lane < 4; ++lane) {
      batch.at(0, lane) = 3.0 + 2.0 * Rng(4).normal(4 * step + lane);
      all.push_back(batch.at(0, lane));
    }
    update_moments(moments, batch.view());
  }

  double mean = 0.0, variance = 0.0;
  for (const double x : all) mean += x / 4000.0;
  for (const double x : all) variance += (x - mean) * (x - mean) / 4000.0;
  // The prior is 1e-4 samples of mean 0 and variance 1, merged by the same formula.
  const double with_prior = mean * 4000.0 / 4000.0001;
  const double squares = variance * 4000.0 + 1e-4 + mean * mean * 4000.0 * 1e-4 / 4000.0001;
  CHECK(std::abs(moments.mean[0] - with_prior) < 1e-9);
  CHECK(std::abs(moments.variance[0] - squares / 4000.0001) < 1e-9);
  CHECK(moments.count == doctest::Approx(4000.0001));

  const RunningMoments frozen = moments;
  normalise(moments, batch.view(), batch.view());
  CHECK(moments.mean == frozen.mean);
  CHECK(moments.variance == frozen.variance);
  CHECK(moments.count == frozen.count);
}

TEST_CASE("normalised numbers are centred, scaled and clipped at ten") {
  RunningMoments moments(1);
  moments.mean = {2.0};
  moments.variance = {4.0 - 1e-8};
  Matrix<double> x(1, 3);
  x.at(0, 1) = 6.0;
  x.at(0, 2) = -1e6;

  normalise(moments, x.view(), x.view());

  CHECK(x.at(0, 0) == -1.0);
  CHECK(x.at(0, 1) == 2.0);
  CHECK(x.at(0, 2) == -10.0);
}

TEST_CASE("the reward scale starts a new sum for finished environments only") {
  RewardScale scale(2);
  const std::vector<std::uint8_t> done = {0, 1};
  std::vector<double> reward = {1.0, 1.0};

  scale_rewards(scale, 0.5, done, reward);
  reward = {1.0, 1.0};
  scale_rewards(scale, 0.5, done, reward);

  CHECK(scale.discounted == std::vector<double>{1.5, 0.0});
}
