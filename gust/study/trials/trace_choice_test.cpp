#include "gust/study/trials/trace_choice.h"

#include <doctest/doctest.h>

using namespace gust;

TEST_CASE("the worst episodes of all and the middle ones of the first episodes are kept") {
  TraceChoice choice({.worst = 2, .median = 1}, /*higher_is_better=*/true);
  const double scores[] = {0.875, 0.125, 0.5, 0.375, 0.75};

  for (std::size_t cell = 0; cell < 5; ++cell) {
    choice.offer({cell, 0, 0}, scores[cell]);
    choice.offer({cell, 0, 1}, 0.25 + scores[cell]);
  }

  const std::vector<EpisodeIndex> chosen = choice.chosen();
  REQUIRE(chosen.size() == 3);
  CHECK(chosen[0].cell == 1);
  CHECK(chosen[0].episode == 0);
  CHECK(chosen[1].cell == 1);  // 0.375 twice: the earlier one stays
  CHECK(chosen[1].episode == 1);
  CHECK(chosen[2].cell == 2);
}

TEST_CASE("an error is worst when it is greatest, and no number is worst of all") {
  TraceChoice choice({.worst = 2, .median = 0}, /*higher_is_better=*/false);

  choice.offer({0, 0, 0}, 1.0);
  choice.offer({1, 0, 0}, std::numeric_limits<double>::quiet_NaN());
  choice.offer({2, 0, 0}, 3.0);

  const std::vector<EpisodeIndex> chosen = choice.chosen();
  REQUIRE(chosen.size() == 2);
  CHECK(chosen[0].cell == 1);
  CHECK(chosen[1].cell == 2);
}
