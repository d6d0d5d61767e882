#include "gust/control/tracking.h"

#include <doctest/doctest.h>

#include "gust/control/adder_plant_test.h"
#include "gust/control/cascade.h"

using namespace gust;

namespace {

Made<Plant> quadrotor(const char* trajectory) {
  return plants().at("quadrotor").make(Table{{{"trajectory", {std::string(trajectory), {}}}}, {"test"}});
}

/// Mean reward of an undisturbed episode from the nominal start.
double mean_reward(const Plant& plant, Policy& policy) {
  const PlantSpec& spec = plant.spec();
  ClosedLoop loop(plant, Readings{}, {}, 1);
  loop.begin(0, {spec.start, nominal_parameters(spec), {}, {}, 0});
  Matrix<double> command(spec.action.size(), 1);
  double sum = 0;
  for (std::int64_t k = 0; k < spec.steps; ++k) {
    policy.act(loop.observation(), loop.steps_done(), command.view());
    loop.step(command.view());
    sum += loop.failed(0) ? 0.0 : loop.reward()[0];
  }
  return sum / static_cast<double>(spec.steps);
}

}  // namespace

TEST_CASE("the regulator and the cascade track every trajectory far better than parking") {
  for (const char* trajectory : {"circle", "figure8", "square"}) {
    CAPTURE(trajectory);
    const Made<Plant> plant = quadrotor(trajectory);

    const double lqr = mean_reward(*plant, *lqr_policy(*plant, reward_weights(plant->spec())));
    const double pd = mean_reward(*plant, *cascade_policy(*plant, *plant->spec().cascade));

    CHECK(lqr > 0.97);
    CHECK(pd > 0.98);
  }
}

TEST_CASE("on a linear plant the tracking regulator finds the optimum of the quadratic problem") {
  // a(k+1) = a(k) + u(k), reference 10 (k + 1), q = 1, r -> 0: every step goes straight to the reference.
  class LinearAdder final : public Plant {
   public:
    LinearAdder() {
      plain_.spec_.references = 9;
      plain_.spec_.action_low = {-1e9};
      plain_.spec_.action_high = {1e9};
    }
    const PlantSpec& spec() const override { return plain_.spec_; }
    void advance(const Motion& motion) const noexcept override { plain_.advance(motion); }
    void reference(std::size_t sample, std::span<double> state) const noexcept override {
      plain_.reference(sample, state);
    }
    void begin(Rows<double>, std::size_t, bool) const noexcept override {}
    bool near_ground(std::span<const double>) const noexcept override { return false; }
    Linearisation linearise(std::span<const double>, std::span<const double>) const override {
      Linearisation model{Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Zero(2, 1)};
      model.b(0, 0) = 1.0;
      return model;
    }

   private:
    AdderPlant plain_;
  } plant;

  const auto knots = tracking_knots(plant, {{1, 0}, {1e-9}}, reference_knots(plant, Eigen::MatrixXd::Zero(1, 2)));

  REQUIRE(knots.size() == 8);
  CHECK(knots[0].action[0] == doctest::Approx(9.0));  // from 1 to 10
  for (std::size_t k = 1; k < 8; ++k) {
    CHECK(knots[k].action[0] == doctest::Approx(10.0));
    CHECK(knots[k].state[0] == doctest::Approx(10.0 * static_cast<double>(k)));
    CHECK(knots[k].gain(0, 0) == doctest::Approx(1.0));
  }
}
