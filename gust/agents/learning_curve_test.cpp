#include "gust/agents/learning_curve.h"

#include <doctest/doctest.h>

using namespace gust;

namespace {

Made<Plant> cartpole(double start_range) {
  const auto number = [](double value) { return Value{value, {}}; };
  return plants().make({{{"kind", Value{std::string("cartpole"), {}}},
                         {"steps", Value{std::int64_t{50}, {}}},
                         {"start_range", Value{Value::List{number(start_range), number(0), number(0), number(0)}, {}}}},
                        {}});
}

/// An actor that does nothing.
ActorNetwork idle() { return {Mlp<float>({{4, 8, 1}})}; }

/// A training whose actor does nothing, ever.
class IdleTraining final : public Training {
 public:
  void advance() override {}
  bool done() const override { return true; }
  std::int64_t steps() const override { return 0; }
  std::int64_t total_steps() const override { return 0; }
  const std::string& failure() const override { return failure_; }
  const std::vector<CurvePoint>& curve() const override { return curve_; }
  ActorNetwork actor() const override { return idle(); }
  std::string save() const override { return {}; }
  void load(std::string_view) override {}

 private:
  std::string failure_;
  std::vector<CurvePoint> curve_;
};

}  // namespace

TEST_CASE("an actor that stays at the goal earns a reward of one a step") {
  const auto plant = cartpole(0.0);
  const TrainingTask task{plant.object.get(), {}, {}, 1};

  const CurvePoint point = measure_actor(task, idle(), Rng(3));

  CHECK(point.return_mean == doctest::Approx(50.0).epsilon(1e-14));  // ten sums of tenths
  CHECK(point.length_mean == doctest::Approx(50.0).epsilon(1e-14));
  CHECK(point.anr == doctest::Approx(1.0).epsilon(1e-14));
  CHECK(point.anr_h == doctest::Approx(1.0).epsilon(1e-14));
  CHECK(point.rmse_scg == 0.0);
  CHECK(point.return_std < 1e-5);  // the root of what cancels
}

TEST_CASE("equal streams give equal points and others do not") {
  const auto plant = cartpole(0.3);
  const TrainingTask task{plant.object.get(), {}, {}, 1};

  const CurvePoint point = measure_actor(task, idle(), Rng(3));

  CHECK(point.return_mean == measure_actor(task, idle(), Rng(3)).return_mean);
  CHECK(point.return_mean != measure_actor(task, idle(), Rng(4)).return_mean);
  CHECK(point.return_mean < 50.0);
  CHECK(point.return_std > 0.0);
}

TEST_CASE("a curve has a point at the start, one after every 20,000 steps, and one at the end") {
  const auto plant = cartpole(0.0);
  LearningCurve curve({plant.object.get(), {}, {}, 1}, Rng(5));
  const IdleTraining training;

  for (const std::int64_t steps : {0, 6'400, 19'200, 25'600, 32'000, 44'800}) curve.follow(training, steps, false);
  curve.follow(training, 45'000, true);

  std::vector<std::int64_t> steps;
  for (const CurvePoint& point : curve.points()) steps.push_back(point.steps);
  CHECK(steps == std::vector<std::int64_t>{0, 25'600, 44'800, 45'000});
}
