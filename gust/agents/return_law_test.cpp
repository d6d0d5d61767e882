#include "gust/agents/return_law.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "gust/core/rng.h"

using namespace gust;

namespace {

/// Draws of N(1, 1) as points of its density, for expectations without noise.
struct NormalGrid {
  static constexpr int kPoints = 4001;
  std::vector<double> reward, weight;

  NormalGrid() {
    double total = 0.0;
    for (int i = 0; i < kPoints; ++i) {
      const double z = -9.0 + 18.0 * i / (kPoints - 1);
      reward.push_back(1.0 + z);
      weight.push_back(std::exp(-0.5 * z * z));
      total += weight.back();
    }
    for (double& w : weight) w /= total;
  }
};

/// Where the expected gradient of the loss vanishes, for rewards N(1, 1) that are followed by `next`.
ReturnLaw fixed_point(const ReturnLossOptions& options, const ReturnLaw& next, double follows) {
  static const NormalGrid grid;
  ReturnLaw law{0.0, 0.0};
  for (int i = 0; i < NormalGrid::kPoints; ++i)
    law.mean += grid.weight[i] * return_target(options, {grid.reward[i], follows, 0.0, next}, 0.0).mean;
  double square = 0.0;
  for (int i = 0; i < NormalGrid::kPoints; ++i) {
    const ReturnTarget target = return_target(options, {grid.reward[i], follows, 0.0, next}, law.mean);
    law.deviation += grid.weight[i] * std::sqrt(std::max(target.variance, 1e-8));
    square += grid.weight[i] * target.variance;
  }
  if (options.loss != VarianceLoss::kWasserstein) law.deviation = std::sqrt(square);
  return law;
}

/// The law of one state that follows itself for ever.
ReturnLaw endless(const ReturnLossOptions& options) {
  ReturnLaw law{1.0 / (1.0 - options.discount), 1.0};  // the mean is linear: its fixed point is known
  const int rounds = static_cast<int>(20.0 / (1.0 - options.discount));
  for (int round = 0; round < rounds; ++round) law = fixed_point(options, law, 1.0);
  return law;
}

/// The law of the first of ten states in a row.
ReturnLaw chain(const ReturnLossOptions& options) {
  ReturnLaw law = fixed_point(options, {}, 0.0);
  for (int step = 1; step < 10; ++step) law = fixed_point(options, law, 1.0);
  return law;
}

constexpr ReturnLossOptions kPublished{.discount = 0.9};
constexpr ReturnLossOptions kTdBiased{.discount = 0.9, .second_moment = false};
constexpr ReturnLossOptions kUnbiased{.discount = 0.9, .second_moment = false, .loss = VarianceLoss::kUnbiased};
constexpr ReturnLossOptions kDivergent{.discount = 0.9, .second_moment = false, .loss = VarianceLoss::kDivergence};
constexpr ReturnLossOptions kSecondUnbiased{.discount = 0.9, .loss = VarianceLoss::kUnbiased};

}  // namespace

TEST_CASE("8.6.2 the moments of an endless stream of rewards N(1, 1) are exact where they are not biased") {
  for (const bool second_moment : {false, true}) {
    ReturnLossOptions options{.second_moment = second_moment, .loss = VarianceLoss::kUnbiased};
    options.discount = 0.9;
    CHECK(std::abs(endless(options).mean - 10.0) < 1e-9);
    CHECK(std::abs(endless(options).variance() - 1.0 / 0.19) < 1e-9);
    options.discount = 0.99;
    CHECK(std::abs(endless(options).mean - 100.0) < 1e-9);
    CHECK(std::abs(endless(options).variance() - 1.0 / 0.0199) < 1e-9);
  }
}

TEST_CASE("8.6.2 the Wasserstein loss has its own fixed points") {
  CHECK(endless(kTdBiased).mean == doctest::Approx(10.0).epsilon(1e-9));
  CHECK(std::abs(endless(kTdBiased).variance() - 4.849) < 1e-3);
  CHECK(std::abs(endless(kPublished).variance() - 5.399) < 1e-3);
}

TEST_CASE("8.6.3 the moments of a chain of ten rewards, unbiased and not") {
  CHECK(std::abs(chain(kUnbiased).mean - 6.513216) < 1e-6);
  CHECK(std::abs(chain(kUnbiased).variance() - 4.623281) < 1e-6);
  CHECK(std::abs(chain(kDivergent).variance() - 4.623281) < 1e-6);
  CHECK(std::abs(chain(kSecondUnbiased).variance() - 4.623281) < 1e-6);
  CHECK(std::abs(chain(kTdBiased).variance() - 4.080886) < 1e-5);
  CHECK(std::abs(chain(kPublished).variance() - 3.495433) < 1e-4);
}

TEST_CASE("8.6.5 the factored second moment is the published expansion") {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Rng rng = Rng(1).split(i);
    const double r = rng.normal(0), q = 10.0 * rng.normal(1), next = 10.0 * rng.normal(2), v = rng.uniform(3);
    const double g = kPublished.discount;
    const double expanded = r * r + 2 * g * r * next + g * g * next * next + g * g * v - q * q;

    const double factored = return_target(kPublished, {r, 1.0, 0.0, {next, std::sqrt(v)}}, q).variance;

    const double size = r * r + g * g * next * next + q * q;  // of what cancels in the expansion
    CHECK(std::abs(factored - expanded) < 1e-9 * size);
  }
}

TEST_CASE("8.6.5 the two forms of the Wasserstein loss are equal") {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Rng rng = Rng(2).split(i);
    const ReturnLaw law{rng.normal(0), 0.1 + rng.uniform(1)};
    const ReturnTarget target{rng.normal(2), 0.1 + rng.uniform(3)};
    const double miss = law.mean - target.mean;
    const double other =
        miss * miss + law.variance() + target.variance - 2 * std::sqrt(law.variance() * target.variance);

    CHECK(std::abs(return_loss(kPublished, law, target) - other) < 1e-10);
  }
}

TEST_CASE("8.6.3 the divergence is least at the mean of its targets, and has the unit of the mean's loss") {
  const ReturnLaw next{3.0, 2.0};
  const ReturnLaw exact = fixed_point(kUnbiased, next, 1.0);
  for (const double unit : {1.0, 1000.0}) {
    const ReturnLaw scaled{unit * exact.mean, unit * exact.deviation};
    double slope = 0.0;  // at the deviation: sigmoid(x) is one for a large x
    double wider = 0.0;
    const NormalGrid grid;
    for (int i = 0; i < NormalGrid::kPoints; ++i) {
      const ReturnSample sample{unit * grid.reward[i], 1.0, 0.0, {unit * next.mean, unit * next.deviation}};
      const ReturnTarget target = return_target(kDivergent, sample, scaled.mean);
      slope += grid.weight[i] * return_loss_slope(kDivergent, scaled, 800.0, target).raw;
      wider += grid.weight[i] * return_loss_slope(kDivergent, {scaled.mean, 2.0 * scaled.deviation}, 800.0, target).raw;
    }
    CAPTURE(unit);
    CHECK(std::abs(slope / unit) < 1e-9);
    CHECK(wider / scaled.deviation == doctest::Approx(3.0).epsilon(1e-9));  // 2 (2 - 1 / 2)
  }
}

TEST_CASE("8.6.5 both variance targets have the same mean where Q is exact") {
  constexpr std::uint64_t kDraws = 1'000'000;
  const ReturnLaw next{10.0, std::sqrt(1.0 / 0.19)};
  double second = 0.0, squared = 0.0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const ReturnSample sample{1.0 + Rng(4).normal(i), 1.0, 0.0, next};
    second += return_target(kSecondUnbiased, sample, 10.0).variance / kDraws;
    squared += return_target(kUnbiased, sample, 10.0).variance / kDraws;
  }
  // The second moment carries 2 Q delta, which has a deviation of 20: 0.02 in the mean of a million draws.
  CHECK(std::abs(second / squared - 1.0) < 0.01);
}

TEST_CASE("8.1.1 finite differences confirm the slopes of a return critic's losses and of its risk") {
  const auto agrees = [](auto&& f, double at, double slope) {
    const double h = 1e-5;
    return std::abs((f(at + h) - f(at - h)) / (2 * h) - slope) < 1e-6 * std::max(std::abs(slope), 1e-2);
  };
  for (const ReturnLossOptions& options : {kPublished, kTdBiased, kUnbiased, kDivergent, kSecondUnbiased}) {
    for (std::uint64_t i = 0; i < 50; ++i) {
      const Rng rng = Rng(5).split(i);
      const double q = 3.0 + rng.normal(0), x = 2.0 * rng.normal(1), c = 2.0 * rng.uniform(6);
      const ReturnSample sample{rng.normal(2), i % 3 == 0 ? 0.0 : 1.0, 0.2, {3.0 + rng.normal(4), rng.uniform(5)}};
      const ReturnTarget target = return_target(options, sample, q);  // detached: it stays while the outputs move

      const OutputSlope loss = return_loss_slope(options, return_law(q, x), x, target);
      const OutputSlope risk = cvar_slope(c, x);

      CHECK(agrees([&](double at) { return return_loss(options, return_law(at, x), target); }, q, loss.mean));
      CHECK(agrees([&](double at) { return return_loss(options, return_law(q, at), target); }, x, loss.raw));
      CHECK(agrees([&](double at) { return return_law(at, x).cvar(c); }, q, risk.mean));
      CHECK(agrees([&](double at) { return return_law(q, at).cvar(c); }, x, risk.raw));
    }
  }
}

TEST_CASE("the deviation stays positive and finite for outputs of any size") {
  for (const double x : {-1e30, -100.0, -1.0, 0.0, 1.0, 100.0, 1e30}) {
    CAPTURE(x);
    CHECK(return_law(0.0, x).deviation >= kLeastDeviation);
    CHECK(std::isfinite(return_law(0.0, x).deviation));
  }
}

TEST_CASE("entropy is part of the mean always, of the variance if wanted") {
  ReturnLossOptions options{.discount = 0.5, .second_moment = false};
  const ReturnSample sample{1.0, 1.0, 0.5, {2.0, 1.0}};

  CHECK(return_target(options, sample, 0.0).mean == 1.75);
  CHECK(return_target(options, sample, 0.0).variance == 1.75 * 1.75 + 0.25);
  options.entropy_in_variance = false;
  CHECK(return_target(options, sample, 0.0).mean == 1.75);
  CHECK(return_target(options, sample, 0.0).variance == 4.0 + 0.25);
}
