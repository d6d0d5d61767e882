#include "gust/control/episode.h"

#include <cmath>

#include "gust/control/adder_plant_test.h"

using namespace gust;

namespace {

/// An episode of the adder under a constant command, from a = `start`, with a constant action disturbance.
Episode run(double start, double command, double level = 0, int steps = 8) {
  const AdderPlant plant;
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kAction, waveform("constant"), 1));
  ClosedLoop loop(plant, Readings{.effort = "disturbed"}, injections, 1);
  EpisodeStart begin = start_at_zero(plant, injections, {level});
  begin.state = {start, 0.5};
  loop.begin(0, begin);
  EpisodeMeter meter(plant.spec(), 1);
  for (int k = 0; k < steps; ++k) {
    step_all(loop, command);
    meter.record(loop.record());
  }
  return meter.episode(0);
}

}  // namespace

TEST_CASE("an episode that does not fail ends with its horizon, both parts alike") {
  const Episode episode = run(0.0, 0.125);  // a = 0.25, 0.5, … 2

  CHECK_FALSE(episode.failed);
  CHECK(episode.finite);
  CHECK(episode.horizon == 8);
  CHECK(episode.control_rate == 10);
  CHECK(episode.ended.steps == 8);
  CHECK(episode.whole.steps == 8);
  CHECK(episode.safe_steps == 8);
  CHECK(episode.whole.final_state == std::vector<double>{2.0, 0.5});
  CHECK(episode.whole.max_abs_state == std::vector<double>{2.0, 0.5});
  double reward = 0, squared = 0;
  for (int k = 1; k <= 8; ++k) {
    const double a = 0.25 * k;
    reward += std::exp(-(a * a + 0.5 * 0.25 * 0.25));
    squared += a * a + 0.5 * 0.5;
  }
  CHECK(episode.whole.return_sum == doctest::Approx(reward).epsilon(1e-14));
  CHECK(episode.whole.squared_error == squared);               // sums of sixteenths are exact
  CHECK(episode.whole.squared_state == squared);               // the goal is 0
  CHECK(episode.whole.squared_masked_error == 8 * 0.5 * 0.5);  // the second component alone
  CHECK(episode.ended.return_sum == episode.whole.return_sum);
}

TEST_CASE("the first action that is NaN or infinite is kept with its step and state") {
  const AdderPlant plant;
  for (const double value : {std::nan(""), HUGE_VAL}) {
    ClosedLoop loop(plant, Readings{}, {}, 1);
    EpisodeStart begin = start_at_zero(plant, {}, {});
    loop.begin(0, begin);
    EpisodeMeter meter(plant.spec(), 1);
    for (const double command : {0.5, 0.25, value, value}) {
      step_all(loop, command);
      meter.record(loop.record());
    }

    const std::optional<NotFiniteAction>& action = meter.episode(0).not_finite;
    REQUIRE(action);
    CHECK(action->step == 2);
    CHECK(action->state == std::vector<double>{1.5, 0});
    const std::string gave = std::isnan(value) ? "NaN" : "an infinite action";
    CHECK(not_finite_text(*action, plant.spec()) == "the policy gave " + gave + " at step 2, state a = 1.5 m, b = 0 m");
  }
  CHECK_FALSE(run(0.0, 0.125).not_finite);
}

TEST_CASE("failure ends one part with the step that failed, and the other runs on") {
  const Episode episode = run(95.0, 1.0);  // 97, 99, 101, …

  CHECK(episode.failed);
  CHECK(episode.safe_steps == 3);
  CHECK(episode.ended.steps == 3);
  CHECK(episode.ended.final_state[0] == 101.0);
  CHECK(episode.ended.max_abs_state[0] == 101.0);
  CHECK(episode.whole.steps == 8);
  CHECK(episode.whole.final_state[0] == 111.0);
  CHECK(episode.ended.squared_masked_error == 3 * 0.25);
  CHECK(episode.ended.squared_state == 97.0 * 97.0 + 99.0 * 99.0 + 101.0 * 101.0 + 3 * 0.25);  // the last state too
  CHECK(&episode.part(true) == &episode.ended);
  CHECK(&episode.part(false) == &episode.whole);
}

TEST_CASE("a state that comes back after failing has still failed") {
  const AdderPlant plant;
  ClosedLoop loop(plant, Readings{}, {}, 1);
  loop.begin(0, {{99.5, 0}, {1.0}, {}, {}});
  EpisodeMeter meter(plant.spec(), 1);

  for (const double command : {0.5, -1.0, -1.0}) {
    step_all(loop, command);
    meter.record(loop.record());
  }

  CHECK_FALSE(loop.failed(0));
  CHECK(meter.episode(0).failed);
  CHECK(meter.episode(0).ended.steps == 1);
  CHECK(meter.episode(0).whole.steps == 3);
}

TEST_CASE("steps beyond the horizon are not counted") {
  CHECK(run(0.0, 0.125, 0, 20).whole.steps == 8);
  CHECK(run(0.0, 0.125, 0, 20).whole.final_state[0] == 2.0);
}

TEST_CASE("a step is saturated when the actuator cannot give the disturbed sum") {
  CHECK(run(0.0, 1.0, 2.0).whole.saturated_steps == 0);  // exactly 4
  CHECK(run(0.0, 1.0, 2.5).whole.saturated_steps == 8);
  CHECK(run(0.0, -1.0, -2.5).whole.saturated_steps == 8);
}

TEST_CASE("commanded and disturbed returns are kept apart") {
  const Episode episode = run(0.0, 0.5, -1.0);  // 1 commanded, 0 disturbed: a stays 0

  CHECK(episode.whole.return_disturbed == 8.0);
  CHECK(episode.whole.return_commanded == doctest::Approx(8 * std::exp(-0.5)).epsilon(1e-14));
  CHECK(episode.whole.return_sum == episode.whole.return_disturbed);
}

TEST_CASE("NaN fails the episode and is told as such") {
  const Episode episode = run(NAN, 0.0);

  CHECK(episode.failed);
  CHECK_FALSE(episode.finite);
  CHECK(episode.ended.steps == 1);
}

TEST_CASE("lanes are counted apart, and begin anew by themselves") {
  const AdderPlant plant;
  ClosedLoop loop(plant, Readings{}, {}, 2);
  for (std::size_t lane = 0; lane < 2; ++lane) loop.begin(lane, {{0, 0}, {1.0}, {}, {}});
  EpisodeMeter meter(plant.spec(), 2);

  for (int k = 0; k < 5; ++k) {
    step_all(loop, 0.5);
    meter.record(loop.record());
    if (k == 2) {
      loop.begin(1, {{0, 0}, {1.0}, {}, {}});
      meter.begin(1);
    }
  }

  CHECK(meter.episode(0).whole.steps == 5);
  CHECK(meter.episode(0).whole.final_state[0] == 5.0);
  CHECK(meter.episode(1).whole.steps == 2);
  CHECK(meter.episode(1).whole.final_state[0] == 2.0);
}

namespace {

/// What a loop without state, goal and effort tells of one lane.
struct Lane {
  double reward = 0;
  std::uint8_t failed = 0, over = 0;

  StepRecord record() const { return {.reward = {&reward, 1}, .failed = {&failed, 1}, .over = {&over, 1}}; }
};

Interface four_steps() {
  Interface spec;
  spec.steps = 4;
  spec.control_rate = 10;
  spec.tells_effort = false;
  return spec;
}

}  // namespace

TEST_CASE("an episode that is over counts no further step, and has not failed") {
  const Interface spec = four_steps();
  EpisodeMeter meter(spec, 1);

  meter.record(Lane{.reward = 1}.record());
  meter.record(Lane{.reward = 2, .over = 1}.record());
  meter.record(Lane{.reward = 4, .failed = 1}.record());

  const Episode& episode = meter.episode(0);
  CHECK(episode.over);
  CHECK_FALSE(episode.failed);
  CHECK(episode.ended.steps == 2);
  CHECK(episode.whole.return_sum == 3);
  CHECK(std::isnan(episode.ended.return_commanded));  // it has one reward only
  CHECK(episode.finite);
}

TEST_CASE("where nothing is told after a failure, both parts of the episode end with it") {
  Interface spec = four_steps();
  spec.goes_on = false;
  EpisodeMeter meter(spec, 1);

  meter.record(Lane{.reward = 1}.record());
  meter.record(Lane{.reward = 2, .failed = 1}.record());
  meter.record(Lane{.reward = 4}.record());

  CHECK(meter.episode(0).failed);
  CHECK(meter.episode(0).whole.steps == 2);
  CHECK(meter.episode(0).ended.return_sum == 3);
}

TEST_CASE("an action that is not finite is told with the state, where a state is told") {
  const AdderPlant plant;

  CHECK(not_finite_text({3, NAN, {1.5, -2}}, plant.spec()) ==
        "the policy gave NaN at step 3, state a = 1.5 m, b = -2 m");
  CHECK(not_finite_text({3, INFINITY, {}}, four_steps()) == "the policy gave an infinite action at step 3");
}

TEST_CASE("a record without what the interface says to be told is a mistake of the loop") {
  Interface spec = four_steps();
  spec.state = {{"x", "m"}};
  EpisodeMeter meter(spec, 1);

  CHECK_THROWS_AS(meter.record(Lane{}.record()), Bug);
}
