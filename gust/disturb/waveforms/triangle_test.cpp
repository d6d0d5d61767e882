#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("triangle rises from -1 to 1 and falls at the same rate") {
  const auto made = waveform("triangle", {{"frequency", number(1)}});

  CHECK(values_of(made, 9, 8) == std::vector<double>{-1, -0.5, 0, 0.5, 1, 0.5, 0, -0.5, -1});
}

TEST_CASE("unipolar triangle rises from 0 to 1 and falls at the same rate") {
  const auto made = waveform("triangle", {{"polarity", word("unipolar")}});

  CHECK(values_of(made, 9, 8) == std::vector<double>{0, 0.25, 0.5, 0.75, 1, 0.75, 0.5, 0.25, 0});
}

TEST_CASE("half a period of phase starts triangle at its top") {
  const auto made = waveform("triangle", {{"phase", number(0.5)}});

  CHECK(values_of(made, 5, 8) == std::vector<double>{1, 0.5, 0, -0.5, -1});
}
