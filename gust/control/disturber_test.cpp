#include "gust/control/disturber.h"

#include "gust/control/adder_plant_test.h"

using namespace gust;

TEST_CASE("the disturbances of a site are added in their order, then the offset, and other sites' are left alone") {
  const AdderPlant plant;
  std::vector<Injection> injections;
  injections.push_back(disturbance(Site::kAction, waveform("constant"), 1));
  injections.push_back(disturbance(Site::kDynamics, waveform("constant"), 1));
  injections.push_back(disturbance(Site::kAction, waveform("step"), 1));  // from step 2 on
  Disturber disturber(injections, {plant.spec().steps}, 2);
  disturber.begin(0, start_at_zero(plant, injections, {1.0, 100.0, 10.0}));
  disturber.begin(1, start_at_zero(plant, injections, {2.0, 100.0, 20.0}));
  Matrix<double> signal(1, 2, 0.5);
  const Matrix<double> offset(1, 2, 0.25);
  const std::vector<std::int64_t> step = {0, 3};

  disturber.apply(Site::kAction, step, signal.view(), offset.view());

  CHECK(signal.at(0, 0) == 1.75);
  CHECK(signal.at(0, 1) == 22.75);
}

TEST_CASE("without disturbances a signal stays as it is, and an offset is added alone") {
  Disturber disturber({}, {8}, 1);
  disturber.begin(0, {});
  Matrix<double> signal(2, 1, 1.0);
  const std::vector<std::int64_t> step = {5};

  disturber.apply(Site::kObservation, step, signal.view(), {});
  CHECK(signal.at(0, 0) == 1.0);
  const Matrix<double> offset(1, 1, 3.0);
  disturber.apply(Site::kObservation, step, signal.view(), offset.view());
  CHECK(signal.at(0, 0) == 4.0);
  CHECK(signal.at(1, 0) == 1.0);
}
