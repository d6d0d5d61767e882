#include "gust/agents/learning_curve.h"

#include <doctest/doctest.h>

using namespace gust;

namespace {

Made<Plant> cartpole(double start_range, double pole_length = 0.5) {
  const auto number = [](double value) { return Value{value, {}}; };
  return plants().make({{{"kind", Value{std::string("cartpole"), {}}},
                         {"steps", Value{std::int64_t{50}, {}}},
                         {"pole_length", Value{pole_length, {}}},
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

TEST_CASE("a curve on the task of the training meets its draws and its disturbances, another one does not") {
  const auto plant = cartpole(0.1);
  const auto text = [](const char* word) { return Value{std::string(word), {}}; };
  const Table push{{{"site", text("dynamics")}, {"waveform", text("step")}, {"level", Value{5.0, {}}}}, {"test"}};
  std::vector<Injection> injections;
  injections.push_back(read_injection(push, plant->spec()));
  const TrainingTask nominal{plant.object.get(), {}, injections, 1};
  TrainingTask trained = nominal;
  trained.curve_as_trained = true;
  const double still = measure_actor(nominal, idle(), Rng(3)).anr_h;

  CHECK(still == measure_actor(TrainingTask{plant.object.get(), {}, {}, 1}, idle(), Rng(3)).anr_h);
  CHECK(measure_actor(trained, idle(), Rng(3)).anr_h < still - 0.1);

  const Value one{Table{{{"low", Value{4.0, {}}}, {"high", Value{4.0, {}}}}, {"test"}}, {"test"}};
  const Randomisation drawn = read_randomisation({{{"pole_length", one}}, {"test"}}, plant->spec());
  trained.injections = {};
  trained.randomised = drawn.draws;
  const auto longer = cartpole(0.1, 4.0);
  CHECK(measure_actor(trained, idle(), Rng(3)).anr_h ==
        measure_actor(TrainingTask{longer.object.get(), {}, {}, 1}, idle(), Rng(3)).anr_h);
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
