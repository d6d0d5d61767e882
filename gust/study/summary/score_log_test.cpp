#include "gust/study/summary/score_log.h"

#include <doctest/doctest.h>

#include <cstring>

using namespace gust;

TEST_CASE("a log of scores keeps each curve once, in alphabetical order, and says where it begins") {
  ScoreLog log;
  CHECK(log.empty());
  log.note({"main/white", "sac", "action white", "random", "anr", "aa", 2, {1, 2, 3, 4}});
  log.note({"main/white", "ppo", "", "random", "anr", "bb", 3, {5, 6, 7}});
  log.note({"main/white", "sac", "action white", "random", "anr", "aa", 2, {9, 9, 9, 9}});  // asked again

  CHECK(log.index() ==
        "study,policy,sweep,start,metric,trainings,units,cells,first\n"
        "main/white,ppo,,random,anr,bb,3,1,0\n"
        "main/white,sac,action white,random,anr,aa,2,2,3\n");
  const std::string bytes = log.values();
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  CHECK(values == std::vector<float>{5, 6, 7, 1, 2, 3, 4});
}
