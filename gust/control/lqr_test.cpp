#include "gust/control/lqr.h"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <fstream>
#include <nlohmann/json.hpp>

#include "gust/control/closed_loop.h"

using namespace gust;

namespace {

const std::vector<std::int64_t> kFirst(8, 0);  // every lane before its first step

using Json = nlohmann::json;

/// What SciPy says; tests/reference/lqr/make.py wrote it.
const Json& reference() {
  static const Json json = [] {
    std::ifstream file(std::string(GUST_TEST_DATA) + "/reference/lqr/lqr.json");
    REQUIRE(file.good());
    return Json::parse(file);
  }();
  return json;
}

Eigen::MatrixXd matrix(const Json& rows) {
  const auto columns = static_cast<Eigen::Index>(rows.at(0).size());
  Eigen::MatrixXd result(static_cast<Eigen::Index>(rows.size()), columns);
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      result(i, j) = rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j)).get<double>();
    }
  }
  return result;
}

double relative_error(const Eigen::MatrixXd& value, const Json& truth) {
  return (value - matrix(truth)).norm() / matrix(truth).norm();
}

LqrWeights weights(const Json& entry) { return {entry.at("q"), entry.at("r")}; }

Made<Plant> cartpole(const Json& entry) {
  Table options{{}, {"test"}};
  for (const auto& [name, value] : entry.at("parameters").items()) options.set(name, {value.get<double>(), {}});
  options.set("control_rate", {entry.at("control_rate").get<double>(), {}});
  options.set("physics_rate", {entry.at("physics_rate").get<double>(), {}});
  return plants().at("cartpole").make(options);
}

Made<Plant> standard_cartpole() { return plants().at("cartpole").make(Table{{}, {"test"}}); }

}  // namespace

TEST_CASE("the Riccati solver agrees with SciPy on systems of 1 to 12 states") {
  for (const Json& entry : reference().at("systems")) {
    const Eigen::MatrixXd a = matrix(entry.at("a"));
    CAPTURE(a.rows());

    const Eigen::MatrixXd cost = solve_riccati(a, matrix(entry.at("b")), weights(entry));

    CHECK(relative_error(cost, entry.at("cost")) < 1e-11);  // both are good to some 1e-13
    CHECK((cost - cost.transpose()).norm() == 0.0);
  }
}

TEST_CASE("the linearisation of the cart-pole is the one derived by hand") {
  for (const Json& entry : reference().at("cartpoles")) {
    const Made<Plant> plant = cartpole(entry);
    const std::vector<double> zero(4);

    const Linearisation model = plant->linearise(zero, std::vector<double>{0});

    CHECK(relative_error(model.a, entry.at("a")) < 1e-14);
    CHECK(relative_error(model.b, entry.at("b")) < 1e-14);
  }
}

TEST_CASE("the gain of the cart-pole is SciPy's gain of its hand-derived linearisation") {
  for (const Json& entry : reference().at("cartpoles")) {
    CAPTURE(entry.at("physics_rate").get<double>());

    const Eigen::MatrixXd gain = lqr_gain(*cartpole(entry), weights(entry));

    CHECK(relative_error(gain, entry.at("gain")) < 1e-8);  // the equation's condition is about 1e6
  }
}

TEST_CASE("the regulator's loop is stable, and its weights are those of the reward made whole") {
  const Made<Plant> plant = standard_cartpole();
  const LqrWeights own = reward_weights(plant->spec());

  const Eigen::MatrixXd gain = lqr_gain(*plant, own);

  CHECK(own.q == std::vector<double>{5, 0.1, 1, 0.1});
  CHECK(own.r == std::vector<double>{1e-4});
  const Linearisation model = plant->linearise(std::vector<double>(4), std::vector<double>{0});
  const Eigen::MatrixXd loop = model.a - model.b * gain;
  CHECK(loop.eigenvalues().cwiseAbs().maxCoeff() < 1.0);
  CHECK(model.a.eigenvalues().cwiseAbs().maxCoeff() > 1.0);  // by itself the pole falls
}

TEST_CASE("a system that no feedback can settle is an error, not a gain") {
  const Eigen::MatrixXd a = 2.0 * Eigen::MatrixXd::Identity(2, 2);
  Eigen::MatrixXd b(2, 1);
  b << 1, 0;  // the second state grows and cannot be reached

  CHECK_THROWS_AS(solve_riccati(a, b, {{1, 1}, {1}}), Error);
}

TEST_CASE("weights that leave a state unstabilised are refused with its name") {
  const Made<Plant> plant = standard_cartpole();
  const auto error = [&](std::vector<double> q) -> std::string {
    try {
      lqr_gain(*plant, {std::move(q), {1e-4}});
    } catch (const Error& refused) {
      return refused.what();
    }
    return {};
  };

  // Without a weight the position is a sum of velocities that nothing brings back: an eigenvalue of 1.
  CHECK(error({0, 0.1, 1, 0.1}).find("it does not bring x to rest (an eigenvalue of modulus 1") != std::string::npos);
  CHECK(error({0, 0, 1, 0.1}).find("does not bring x") != std::string::npos);
  CHECK(error({1e-30, 0.1, 1, 0.1}).find("give x a weight") != std::string::npos);  // it would take years
  CHECK(error({1e-9, 0, 0, 0}).empty());
  CHECK(error({5, 0.1, 1, 0.1}).empty());
  const Made<Plant> drone = plants().at("quadrotor").make(Table{{}, {"test"}});
  CHECK_THROWS_WITH_AS(lqr_gain(*drone, {{1, 1, 0, 1, 1, 1}, {1, 1}}), doctest::Contains("bring z to rest"), Error);
}

TEST_CASE("feedback acts on the distance to the goal, in the policy's own unit") {
  Table options{{{"goal", Value{Value::List{{0.5, {}}, {0.0, {}}, {0.0, {}}, {0.0, {}}}, {}}}}, {"test"}};
  const Made<Plant> normalised = plants().at("cartpole").make(options);
  options.set("normalized_action", {false, {}});
  const Made<Plant> physical = plants().at("cartpole").make(options);
  Eigen::MatrixXd gain(1, 4);
  gain << -2, -4, -32, -8;
  Matrix<double> seen(4, 3);
  Matrix<double> action(1, 3);
  seen.at(0, 0) = 0.5;  // at the goal
  seen.at(0, 1) = 1.5;
  seen.at(0, 2) = 0.5;
  seen.at(2, 2) = 0.25;

  const auto act = [&](const Plant& plant) {
    feedback_policy(plant, gain)->act(seen.view(), kFirst, action.view());
    return std::vector<double>(action.row(0).begin(), action.row(0).end());
  };

  CHECK(act(*physical) == std::vector<double>{0, 2, 8});
  CHECK(act(*normalised) == std::vector<double>{0, 0.2, 0.8});  // of 10 N
  CHECK(feedback_policy(*physical, gain)->observations() == 4);
  CHECK(feedback_policy(*physical, gain)->actions() == 1);
}

TEST_CASE("the regulator keeps the pole upright through a whole episode") {
  const Made<Plant> plant = standard_cartpole();
  const auto policy = feedback_policy(*plant, lqr_gain(*plant, reward_weights(plant->spec())));
  ClosedLoop loop(*plant, Readings{}, {}, 1);
  loop.begin(0, {{0.2, 0, 0.1, 0}, nominal_parameters(plant->spec()), {}, {}, 0});
  Matrix<double> command(1, 1);

  for (int k = 0; k < 250; ++k) {
    policy->act(loop.observation(), loop.steps_done(), command.view());
    loop.step(command.view());
    REQUIRE_FALSE(loop.failed(0));
  }

  for (std::size_t i = 0; i < 4; ++i) CHECK(std::abs(loop.state().at(i, 0)) < 0.01);
}

TEST_CASE("the zero policy does nothing") {
  Matrix<double> seen(4, 2, 3.0);
  Matrix<double> action(1, 2, 7.0);
  const auto policy = zero_policy(4, 1);

  policy->act(seen.view(), kFirst, action.view());

  CHECK(action.at(0, 0) == 0.0);
  CHECK(action.at(0, 1) == 0.0);
  CHECK(policy->observations() == 4);
  CHECK(policy->actions() == 1);
}
