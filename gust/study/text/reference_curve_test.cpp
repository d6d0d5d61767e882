#include "gust/study/text/reference_curve.h"

#include <doctest/doctest.h>

#include "gust/core/error.h"

using namespace gust;

namespace {

const std::string kMonitorText =
    "#{\"t_start\": 1700000000.5, \"env_id\": \"CartPole-v1\"}\nr,l,t\n50.0,100,0.1\n125.0,250,0.4\n250.0,250,0.7\n";

}  // namespace

TEST_CASE("a monitor.csv of Stable-Baselines3 becomes return over horizon against summed steps") {
  const CurvePoints points = read_reference_curve(kMonitorText, "monitor.csv", {.horizon = 250});

  CHECK(points.steps == std::vector<double>{100, 350, 600});
  CHECK(points.score == std::vector<double>{0.2, 0.5, 1.0});
}

TEST_CASE("a monitor's columns mean the same when they are named, and under a byte order mark") {
  const CurvePoints points =
      read_reference_curve("\xef\xbb\xbf" + kMonitorText, "monitor.csv", {.steps = "l", .score = "r", .horizon = 250});

  CHECK(points.steps == std::vector<double>{100, 350, 600});
  CHECK(points.score == std::vector<double>{0.2, 0.5, 1.0});
}

TEST_CASE("a long monitor.csv is averaged over neighbours") {
  std::string text = "#{}\nr,l,t\n";
  for (int i = 0; i < 400; ++i) text += i % 2 == 0 ? "1,10,0\n" : "3,10,0\n";

  const CurvePoints points = read_reference_curve(text, "monitor.csv", {.horizon = 10});

  REQUIRE(points.steps.size() == 200);
  CHECK(points.steps.front() == 20);
  CHECK(points.steps.back() == 4000);
  for (const double score : points.score) CHECK(score == 0.2);
}

TEST_CASE("a progress.csv gives the mean reward of its rollouts, and leaves out rows that have none") {
  const std::string text =
      "rollout/ep_len_mean,rollout/ep_rew_mean,time/total_timesteps,eval/mean_reward\n"
      ",,2048,10\n200,100,4096,\n250,200,6144,220\n";

  const CurvePoints rollouts = read_reference_curve(text, "progress.csv", {.horizon = 250});
  const CurvePoints evaluations =
      read_reference_curve(text, "progress.csv", {.score = "eval/mean_reward", .horizon = 10});

  CHECK(rollouts.steps == std::vector<double>{4096, 6144});
  CHECK(rollouts.score == std::vector<double>{0.4, 0.8});
  CHECK(evaluations.steps == std::vector<double>{2048, 6144});
  CHECK(evaluations.score == std::vector<double>{1, 22});
}

TEST_CASE("any other file needs the names of its columns, and its scores are taken as they are") {
  const CurvePoints points = read_reference_curve("n,score\n10,0.5\n", "a.csv", {.steps = "n", .score = "score"});

  CHECK(points.score == std::vector<double>{0.5});
  CHECK_THROWS_WITH_AS(read_reference_curve("n,score\n10,0.5\n", "a.csv", {.score = "score"}),
                       "a.csv: which column? 'steps' must name one; only monitor.csv and progress.csv of "
                       "Stable-Baselines3 are known without",
                       Error);
  CHECK_THROWS_WITH_AS(read_reference_curve("n,score\n10,\n", "a.csv", {.steps = "n", .score = "score"}),
                       "a.csv: has no row with both 'n' and 'score'", Error);
  CHECK_THROWS_WITH_AS(read_reference_curve("n;score\n10;0,5\n", "a.csv", {.steps = "n", .score = "score"}),
                       "a.csv:1:2: cells are separated by ; here: commas are needed, and points in numbers", Error);
}

TEST_CASE("impossible lengths and steps are refused with their line") {
  const auto problem = [](const std::string& text, const std::string& name, const CurveColumns& columns) {
    try {
      read_reference_curve(text, name, columns);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string progress = "time/total_timesteps,rollout/ep_rew_mean\n";

  CHECK(problem("r,l,t\n1,10,0\n1,-5,1\n", "monitor.csv", {.horizon = 10}) ==
        "monitor.csv:3: 'l' is the length of an episode and must be above 0, got -5");
  CHECK(problem("r,l,t\n1,0,0\n", "monitor.csv", {.horizon = 10}).starts_with("monitor.csv:2: 'l' is the length"));
  CHECK(problem(progress + "2000,1\n1000,2\n", "progress.csv", {.horizon = 10}) ==
        "progress.csv:3: 'time/total_timesteps' must not fall from row to row, got 1000 after 2000; sort the rows");
  CHECK(problem(progress + "-1,1\n", "progress.csv", {.horizon = 10}) ==
        "progress.csv:2: 'time/total_timesteps' counts steps and must be 0 or more, got -1");
  CHECK(problem("n,s\n5,1\n4,1\n", "a.csv", {.steps = "n", .score = "s"}).starts_with("a.csv:3: 'n' must not fall"));
  CHECK(problem(progress + "1000,1\n1000,2\n", "progress.csv", {.horizon = 10}).empty());
}
