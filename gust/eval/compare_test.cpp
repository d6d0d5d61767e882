#include "gust/eval/compare.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "gust/core/error.h"
#include "gust/eval/aggregate.h"

namespace gust {
namespace {

Interval improvement(const Cell& x, const Cell& y, Bootstrap& bootstrap) {
  return probability_of_improvement(std::span(&x, 1), std::span(&y, 1), bootstrap);
}

TEST_CASE("8.8.5 the probability of improvement over an identical sample is exactly one half") {
  const std::array values = {0.3, 0.1, 0.1, 0.7, 0.9, 0.35, 0.2};

  CHECK(probability_of_improvement(values, values) == 0.5);
}

TEST_CASE("the probability of improvement counts larger pairs, and ties by half") {
  CHECK(probability_of_improvement(std::array{1.0, 3.0}, std::array{2.0}) == 0.5);
  CHECK(probability_of_improvement(std::array{2.0, 3.0}, std::array{2.0, 0.0}) == 0.875);
  CHECK(std::isnan(probability_of_improvement(std::array{2.0, std::nan("")}, std::array{2.0})));
  CHECK(std::isnan(probability_of_improvement(std::array{2.0}, std::span<const double>{})));
}

TEST_CASE("a policy that is always better improves with certainty") {
  Bootstrap bootstrap(Rng(1));
  const std::vector<double> better = {2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0};
  const std::vector<double> worse = {0.0, 1.0, 1.5};

  const Interval found = improvement(cell_of(better, 7), cell_of(worse, 3), bootstrap);

  CHECK(found.estimate == 1.0);
  CHECK(found.low == 1.0);
  CHECK(found.high == 1.0);
  CHECK(found.unit == Unit::seeds);
  CHECK(found.n == 3);
}

TEST_CASE("two policies of one seed each are compared over episodes, and one value each gives no interval") {
  Bootstrap bootstrap(Rng(2));
  const std::vector<double> x = {1.0, 2.0, 3.0};
  const std::vector<double> y = {0.0, 2.0, 5.0};

  const Interval episodes = improvement(cell_of(x, 1), cell_of(y, 1), bootstrap);
  const Interval single = improvement(cell_of(std::span(x).first(1), 1), cell_of(std::span(y).first(1), 1), bootstrap);

  CHECK(episodes.unit == Unit::episodes);
  CHECK(episodes.estimate == 4.5 / 9.0);
  CHECK(episodes.low < episodes.estimate);
  CHECK(single.unit == Unit::none);
  CHECK(single.estimate == 1.0);
  CHECK(std::isnan(single.low));
}

TEST_CASE("one seed against several is its mean against theirs") {
  Bootstrap bootstrap(Rng(3));
  const std::vector<double> x = {1.0, 3.0};
  const std::vector<double> y = {0.0, 2.0, 2.0, 8.0, 1.0, 5.0};  // means 1, 5, 3

  const Interval found = improvement(cell_of(x, 1), cell_of(y, 3), bootstrap);

  CHECK(found.unit == Unit::seeds);
  CHECK(found.n == 3);
  CHECK(found.estimate == doctest::Approx(1.0 / 3.0).epsilon(1e-15));
}

TEST_CASE("a constant difference on common episodes has no width, however different the episodes are") {
  Bootstrap bootstrap(Rng(4));
  const std::vector<double> b = {0.0, 8.0, 2.0, 32.0, -4.0, 64.0};
  std::vector<double> a;
  for (const double value : b) a.push_back(value + 0.5);

  for (const std::size_t seeds : {std::size_t{1}, std::size_t{2}}) {
    const Interval found = difference(cell_of(a, seeds), cell_of(b, seeds), bootstrap);

    CHECK(found.estimate == 0.5);
    CHECK(found.low == 0.5);
    CHECK(found.high == 0.5);
    CHECK(found.unit == (seeds == 1 ? Unit::episodes : Unit::seeds));
  }
}

TEST_CASE("a policy without training is held fixed against one with seeds") {
  Bootstrap bootstrap(Rng(5));
  const std::vector<double> lqr = {1.0, 3.0};
  const std::vector<double> ppo = {0.0, 2.0, 3.0, 5.0, 1.0, 3.0};  // means 1, 4, 2

  const Interval found = difference(cell_of(lqr, 1), cell_of(ppo, 3), bootstrap);
  const Interval seeds = interval(cell_of(ppo, 3), Statistic::mean, bootstrap);

  CHECK(found.estimate == doctest::Approx(2.0 - 7.0 / 3.0).epsilon(1e-15));
  CHECK(found.low == 2.0 - 4.0);  // three draws of the same seed, as in 1 of 27 resamples
  CHECK(found.high == 2.0 - 1.0);
  CHECK(found.n == 3);
  CHECK(seeds.high - seeds.low == found.high - found.low);
}

TEST_CASE("different numbers of seeds are drawn by themselves") {
  Bootstrap bootstrap(Rng(6));
  const std::vector<double> a = {0.0, 1.0};
  const std::vector<double> b = {0.0, 0.0, 0.0};

  const Interval found = difference(cell_of(a, 2), cell_of(b, 3), bootstrap);

  CHECK(found.estimate == 0.5);
  CHECK(found.low == 0.0);
  CHECK(found.high == 1.0);
  CHECK(found.n == 2);
}

TEST_CASE("a difference with a NaN has no interval, and one of different episodes is refused") {
  Bootstrap bootstrap(Rng(7));
  const std::vector<double> a = {0.0, std::nan(""), 1.0};
  const std::vector<double> b = {0.0, 1.0};

  const Interval found = difference(cell_of(a, 3), cell_of(b, 2), bootstrap);

  CHECK(std::isnan(found.estimate));
  CHECK(std::isnan(found.low));
  CHECK_THROWS_AS(difference(cell_of(a, 1), cell_of(b, 1), bootstrap), Bug);
}

}  // namespace
}  // namespace gust
