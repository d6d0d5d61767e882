#include "gust/study/policies/policy_source.h"

#include "gust/study/policies/policy_fixture_test.h"

using namespace gust;
using namespace gust::test;

TEST_CASE("what a policy is keeps the text that trials are named by") {
  const Setup cartpole = setup_of("kind = \"cartpole\""), drone = setup_of("kind = \"quadrotor\"");

  CHECK(source_of("kind = \"lqr\"", cartpole)->canonical({}) == "lqr q [5, 0.1, 1, 0.1] r [0.0001]\n");
  CHECK(source_of("kind = \"pd\"", drone)->canonical({}) == "pd\n");
  CHECK(source_of("kind = \"zero\"", cartpole)->canonical({}) == "zero\n");
  const auto train = source_of("kind = \"train\"\nagent = { kind = \"wcpg\" }\nseeds = [3, 5]\nalpha = 0.5", cartpole);
  CHECK(train->canonical({.index = 1, .training = "wcpg-s5-0123"}) == "wcpg-s5-0123\nalpha 0.5\n");
  CHECK(train->members() == std::vector<std::string>{"3", "5"});
  CHECK(train->training()->seeds == std::vector<std::int64_t>{3, 5});
}

TEST_CASE("a kind that is not there is told with the nearest, and a plant without a cascade has no pd") {
  const Setup setup = setup_of("kind = \"cartpole\"");

  CHECK(complaint_about("kind = \"gian\"", setup)
            .find("study.toml:1:8: unknown policy kind 'gian'; did you mean 'gain'?") == 0);
  CHECK(complaint_about("kind = \"pd\"", setup) ==
        "study.toml:1:1: the plant cartpole has no policy 'pd'; try lqr or zero");
  CHECK(complaint_about("kind = \"lqr\"\nq = [1, 2]", setup) == "study.toml:2:5: 'q' must have 4 numbers, got 2");
  CHECK(complaint_about("kind = \"zero\"\nkp = 1", setup).find("unknown key 'kp' in a policy of kind zero") !=
        std::string::npos);
}
