#include "gust/stats/compare.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

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

}  // namespace
}  // namespace gust
