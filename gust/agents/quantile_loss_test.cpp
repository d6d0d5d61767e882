#include "gust/agents/quantile_loss.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "gust/core/rng.h"

using namespace gust;

namespace {

Tiles<double> normals(std::size_t lanes, std::size_t features, std::uint64_t seed) {
  Tiles<double> tiles(lanes, features);
  for (std::size_t lane = 0; lane < lanes; ++lane)
    for (std::size_t i = 0; i < features; ++i) tiles.at(lane, i) = Rng(seed).split(lane).normal(i);
  return tiles;
}

/// The loss of one quantile at 0 against one target, and its gradient.
struct One {
  double loss;
  double gradient;
};
One one(double target, double fraction, double kappa) {
  const Tiles<double> quantile(1, 1);
  Tiles<double> y(1, 1), gradient(1, 1);
  y.at(0, 0) = target;
  const Fractions<double> tau{.shared = std::span(&fraction, 1)};
  const double loss = quantile_loss<double>({quantile, tau, y}, kappa, gradient);
  return {loss, gradient.at(0, 0)};
}

}  // namespace

TEST_CASE("8.7.1 the quantile Huber loss of one fraction and one target") {
  CHECK(one(0.5, 0.1, 1.0).loss == 0.1 * 0.125);
  CHECK(one(-2.0, 0.1, 1.0).loss == doctest::Approx(1.35).epsilon(1e-15));
  CHECK(one(0.5, 0.1, 1.0).gradient == -0.1 * 0.5);
  CHECK(one(-2.0, 0.1, 1.0).gradient == 0.9);
}

TEST_CASE("8.7.1 finite differences confirm the gradient of the quantile Huber loss") {
  for (const double kappa : {1.0, 0.05}) {
    for (const bool own : {false, true}) {
      Tiles<double> quantiles = normals(70, 5, 1), fractions(70, 5), gradient(70, 5), unused(70, 5);
      const Tiles<double> targets = normals(70, 11, 2);
      for (std::size_t lane = 0; lane < 70; ++lane)
        for (std::size_t i = 0; i < 5; ++i) fractions.at(lane, i) = Rng(3).split(lane).uniform(i);
      const std::array<double, 5> shared = {0.02, 0.3, 0.5, 0.77, 0.9};
      const Fractions<double> tau = own ? Fractions<double>{.own = &fractions} : Fractions<double>{.shared = shared};
      const auto loss = [&](Tiles<double>& to) { return quantile_loss<double>({quantiles, tau, targets}, kappa, to); };

      loss(gradient);

      int wrong = 0;
      for (std::size_t lane = 0; lane < 70; ++lane) {
        for (std::size_t i = 0; i < 5; ++i) {
          const double at = quantiles.at(lane, i), h = 1e-6;
          quantiles.at(lane, i) = at + h;
          const double above = loss(unused);
          quantiles.at(lane, i) = at - h;
          const double below = loss(unused);
          quantiles.at(lane, i) = at;
          const double slope = gradient.at(lane, i);
          // At a kink of the slope a central difference is off by about h over the samples.
          wrong += std::abs((above - below) / (2 * h) - slope) > 1e-6 * std::abs(slope) + 1e-9;
        }
      }
      CHECK(wrong == 0);
      for (std::size_t i = 0; i < 5 * kTileLanes; ++i) {  // lanes beyond the batch have no gradient
        if (i % kTileLanes >= 6) CHECK(gradient.tile(1)[i] == 0.0);
      }
    }
  }
}

TEST_CASE("8.7.1 the loss is the mean over lanes, fractions and targets") {
  const Tiles<double> quantiles = normals(2, 3, 1), targets = normals(2, 9, 2);
  const std::array<double, 3> fractions = {0.1, 0.5, 0.8};
  Tiles<double> gradient(2, 3);
  double sum = 0.0;
  for (std::size_t lane = 0; lane < 2; ++lane)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 9; ++j)
        sum += one(targets.at(lane, j) - quantiles.at(lane, i), fractions[i], 0.3).loss;

  const double loss = quantile_loss<double>({quantiles, {.shared = fractions}, targets}, 0.3, gradient);

  CHECK(loss == doctest::Approx(sum / (2 * 3 * 9)).epsilon(1e-13));
}

TEST_CASE("8.7.6 with the median and a wide kappa the loss is a squared error over 4 kappa") {
  const double kappa = 8.0;
  const Tiles<double> quantiles = normals(40, 1, 1), targets = normals(40, 1, 2);
  const std::array<double, 1> median = {0.5};
  Tiles<double> gradient(40, 1);

  const double loss = quantile_loss<double>({quantiles, {.shared = median}, targets}, kappa, gradient);

  double squares = 0.0;
  for (std::size_t lane = 0; lane < 40; ++lane) {
    const double d = quantiles.at(lane, 0) - targets.at(lane, 0);
    squares += d * d / 40;
    CHECK(std::abs(gradient.at(lane, 0) - 2.0 * d / 40 / (4.0 * kappa)) < 1e-10);  // SAC's loss is mean (Q - y)^2
  }
  CHECK(std::abs(loss - squares / (4.0 * kappa)) < 1e-10);
}

TEST_CASE("8.7.2 the loss is least at the quantiles for a small kappa, and at the table's numbers for kappa 1") {
  struct Row {
    double fraction, truth, one, tenth, hundredth;
  };
  constexpr Row kTable[] = {{0.05, -1.6449, -1.3087, -1.6009, -1.6404},
                            {0.1, -1.2816, -0.9930, -1.2427, -1.2776},
                            {0.25, -0.6745, -0.5049, -0.6504, -0.6720}};
  constexpr std::size_t kGrid = 20'001;  // the normal law as points of its density
  std::vector<double> point(kGrid), weight(kGrid);
  for (std::size_t i = 0; i < kGrid; ++i) {
    point[i] = -8.0 + 16.0 * static_cast<double>(i) / (kGrid - 1);
    weight[i] = std::exp(-0.5 * point[i] * point[i]) / std::sqrt(2 * M_PI) * 16.0 / (kGrid - 1);
  }
  const auto least = [&](double fraction, double kappa) {
    double low = -4.0, high = 4.0;
    while (high - low > 1e-7) {
      const double middle = 0.5 * (low + high);
      double slope = 0.0;
      for (std::size_t i = 0; i < kGrid; ++i) slope += weight[i] * one(point[i] - middle, fraction, kappa).gradient;
      (slope < 0.0 ? low : high) = middle;
    }
    return low;
  };

  for (const Row& row : kTable) {
    CAPTURE(row.fraction);
    CHECK(std::abs(least(row.fraction, 1.0) - row.one) < 1e-4);
    CHECK(std::abs(least(row.fraction, 0.1) - row.tenth) < 1e-4);
    CHECK(std::abs(least(row.fraction, 0.01) - row.hundredth) < 1e-4);
    CHECK(std::abs(least(row.fraction, 1e-3) - row.truth) < 1e-3);
  }
}
