#include "gust/control/cascade.h"

#include <doctest/doctest.h>

#include "gust/core/math.h"

using namespace gust;

TEST_CASE("the cascade asks for a bounded attitude and brings it about") {
  const Made<Plant> plant = plants().at("quadrotor").make(Table{{{"task", {std::string("stabilise"), {}}}}, {"test"}});
  const PlantSpec& spec = plant->spec();
  REQUIRE(spec.cascade);
  const Cascade& cascade = *spec.cascade;
  const auto policy = cascade_policy(*plant, cascade);
  std::vector<double> goal(spec.state.size());
  plant->reference(0, goal);

  // Near enough for what the outer loop asks, and so far off that it asks for the limit, on either side.
  for (const double off : {0.01, -0.02, 30.0, -30.0}) {
    CAPTURE(off);
    Matrix<double> observation(policy->observations(), 1), action(policy->actions(), 1);
    Eigen::VectorXd error(static_cast<Eigen::Index>(goal.size()));
    for (std::size_t j = 0; j < goal.size(); ++j) {
      const double error_j = off * static_cast<double>(j + 1);
      error[static_cast<Eigen::Index>(j)] = error_j;
      observation.at(j, 0) = goal[j] - error_j;
    }
    double attitude = 0;
    for (std::size_t j = 0; j < goal.size(); ++j) attitude += cascade.outer[j] * error[static_cast<Eigen::Index>(j)];
    CHECK((std::abs(attitude) > cascade.limit) == (std::abs(off) > 1));
    error[static_cast<Eigen::Index>(spec.angle)] += clip(attitude, -cascade.limit, cascade.limit);

    policy->act(observation.view(), std::vector<std::int64_t>{0}, action.view());

    const Eigen::VectorXd change = cascade.inner * error;
    for (std::size_t i = 0; i < policy->actions(); ++i) {
      const double physical = spec.action_offset[i] + spec.action_scale[i] * action.at(i, 0);
      CHECK(physical == doctest::Approx(spec.action_goal[i] + change[static_cast<Eigen::Index>(i)]));
    }
  }
}
