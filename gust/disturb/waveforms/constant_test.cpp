#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

TEST_CASE("a constant is one at every control step") {
  CHECK(values_of(waveform("constant"), 4) == std::vector<double>{1, 1, 1, 1});
  CHECK(waveform("constant")->onset() == 0);
}
