#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("a step is zero before its offset and one from there on") {
  CHECK(values_of(waveform("step"), 5) == std::vector<double>{0, 0, 1, 1, 1});
  CHECK(values_of(waveform("step", {{"offset", steps(0)}}), 3) == std::vector<double>{1, 1, 1});
  CHECK(values_of(waveform("step", {{"offset", steps(9)}}), 3) == std::vector<double>{0, 0, 0});
}

TEST_CASE("a step says when it begins, and does not begin before the episode") {
  CHECK(waveform("step", {{"offset", steps(9)}})->onset() == 9);
  CHECK_FALSE(waveform("step")->random());
  CHECK_THROWS_WITH_AS(waveform("step", {{"offset", steps(-1)}}), "test: 'offset' must be >= 0, got -1", Error);
}
