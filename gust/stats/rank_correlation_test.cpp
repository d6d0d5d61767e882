#include "gust/stats/rank_correlation.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace gust;

TEST_CASE("an order that is reversed correlates with minus one") {
  const std::vector<double> up = {1, 2, 3, 4}, down = {8, 4, 2, 1};

  CHECK(spearman(up, down) == -1.0);
  CHECK(kendall(up, down) == -1.0);
}

TEST_CASE("where all values are equal no correlation is known") {
  const std::vector<double> equal = {1, 1, 1}, any = {1, 2, 3};

  CHECK(std::isnan(pearson(equal, any)));
  CHECK(std::isnan(spearman(any, equal)));
  CHECK(std::isnan(kendall(equal, any)));
  CHECK(std::isnan(pearson({}, {})));
}
