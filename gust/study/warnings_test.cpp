#include "gust/study/warnings.h"

#include <doctest/doctest.h>

#include "gust/study/parse.h"

using namespace gust;

namespace {

Study quadrotor_study(const std::string& clip) {
  const std::string text =
      "schema = 1\nname = \"q\"\nplant = { kind = \"quadrotor\" }\nreadings = { command_clip = \"" + clip +
      "\" }\n[[policy]]\nname = \"lqr\"\nkind = \"lqr\"\n"
      "[[sweep]]\nname = \"mass\"\nvary = \"mass\"\nscale = [0.5, 0.8, 0.95, 1, 1.05, 1.2]\n";
  return parse_study(text, "q.toml", {},
                     [](const std::string&, const Place&) { return std::vector<StudyPolicy::File>{}; });
}

}  // namespace

TEST_CASE("masses that cannot hover are told with the numbers, by the reach of the command") {
  CHECK(study_warnings(quadrotor_study("box")) ==
        std::vector<std::string>{"sweep 'mass': 3 of 6 values of mass lie where no policy can hold the plant: its "
                                 "actions reach 0.0243 to 0.0297 kg"});
  CHECK(study_warnings(quadrotor_study("none")).empty());
}
