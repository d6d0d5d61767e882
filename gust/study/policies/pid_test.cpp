#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "gust/study/policies/policy_fixture_test.h"

using namespace gust;
using namespace gust::test;

namespace {

using Json = nlohmann::json;

/// The cart-pole whose policies act in newtons.
Setup cartpole() { return setup_of("kind = \"cartpole\"\npreset = \"scg-default\"\nnormalized_action = false"); }

/// What python-control and make.py say; tests/reference/pid/make.py wrote it.
const Json& reference() {
  static const Json json = [] {
    std::ifstream file(std::string(GUST_TEST_DATA) + "/reference/pid/pid.json");
    REQUIRE(file.good());
    return Json::parse(file);
  }();
  return json;
}

Eigen::MatrixXd matrix(const std::string& name) {
  std::ifstream file(std::string(GUST_TEST_DATA) + "/reference/lqr/lqr.json");
  const Json rows = Json::parse(file).at("cartpoles").at(0).at(name);
  Eigen::MatrixXd result(4, static_cast<Eigen::Index>(rows.at(0).size()));
  for (Eigen::Index i = 0; i < 4; ++i) {
    for (Eigen::Index j = 0; j < result.cols(); ++j)
      result(i, j) = rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j)).get<double>();
  }
  return result;
}

/// The loops of a reference as a policy.
std::string policy_of(const Json& loops) {
  std::vector<std::string> tables;
  for (const Json& loop : loops) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : loop.items()) keys.push_back(cat(key, " = ", value.dump()));
    tables.push_back(cat("{ ", join(keys, ", "), " }"));
  }
  return cat("kind = \"pid\"\nloops = [", join(tables, ", "), "]");
}

/// The greatest difference from python-control's closed loop with the linear plant, of states and of actions.
double apart(const Json& wanted) {
  const Setup setup = cartpole();
  const std::unique_ptr<Policy> policy = source_of(policy_of(wanted.at("loops")), setup)->make(setup, {});
  const Eigen::MatrixXd a = matrix("a"), b = matrix("b");
  Eigen::VectorXd state(4);
  for (Eigen::Index i = 0; i < 4; ++i) state[i] = wanted.at("start").at(static_cast<std::size_t>(i)).get<double>();
  Matrix<double> seen(4, 1), action(1, 1);
  double greatest = 0;
  for (std::size_t k = 0; k < wanted.at("states").size(); ++k) {
    for (std::size_t i = 0; i < 4; ++i) seen.at(i, 0) = state[static_cast<Eigen::Index>(i)];
    const std::int64_t step[] = {static_cast<std::int64_t>(k)};
    policy->act(seen.view(), step, action.view());
    greatest = std::max(greatest, std::abs(action.at(0, 0) - wanted.at("action").at(k).get<double>()));
    for (std::size_t i = 0; i < 4; ++i)
      greatest = std::max(greatest, std::abs(seen.at(i, 0) - wanted.at("states").at(k).at(i).get<double>()));
    state = a * state + b * action.at(0, 0);
  }
  return greatest;
}

}  // namespace

TEST_CASE("two loops side by side and two in a cascade are python-control's closed loops") {
  CHECK(apart(reference().at("linear")) < 1e-10);
  CHECK(apart(reference().at("cascade")) < 1e-10);
}

TEST_CASE("limits and each kind of anti-windup are those of the reference, and the integral is there to see") {
  const Setup setup = cartpole();
  for (const Json& wanted : reference().at("limited")) {
    CAPTURE(wanted.at("windup"));
    const auto source =
        source_of(cat("kind = \"pid\"\nof = \"x\"\nkp = 4.0\nki = 9.0\nkd = 0.3\nfilter = 0.05\nlow = -5\nhigh = "
                      "1\nderivative = \"measurement\"\ntracking = 0.25\nwindup = ",
                      wanted.at("windup").dump()),
                  setup);
    const std::unique_ptr<Policy> policy = source->make(setup, {});
    Matrix<double> seen(4, 1), action(1, 1);
    double greatest = 0;
    for (std::size_t k = 0; k < wanted.at("measured").size(); ++k) {
      seen.at(0, 0) = wanted.at("measured").at(k).get<double>();
      const std::int64_t step[] = {static_cast<std::int64_t>(k)};
      policy->act(seen.view(), step, action.view());
      greatest = std::max(greatest, std::abs(action.at(0, 0) - wanted.at("output").at(k).get<double>()));
      greatest =
          std::max(greatest, std::abs(policy->remembered().at(0, 0) - wanted.at("integral").at(k).get<double>()));
    }

    CHECK(greatest < 1e-12);
    REQUIRE(policy->memory().size() == 3);
    CHECK(policy->memory()[0].name == "integral of x to force");
    CHECK(policy->memory()[0].unit == "N");
    CHECK(policy->memory()[2].name == "last value of x to force");
  }
}

TEST_CASE("a loop in degrees and percent is the loop in radians and newtons") {
  const Setup setup = setup_of("kind = \"cartpole\"");
  constexpr double kPerDegree = std::numbers::pi / 180;
  const auto si = source_of("kind = \"pid\"\nof = \"theta\"\nkp = -50\nki = -5\nkd = -9\nlow = -8\nhigh = 8", setup);
  const auto own = source_of(
      cat("kind = \"pid\"\nof = \"theta\"\nunits = { theta = \"deg\", force = \"%\" }\nkp = ", -500 * kPerDegree,
          "\nki = ", -50 * kPerDegree, "\nkd = ", -90 * kPerDegree, "\nlow = -80\nhigh = 80"),
      setup);
  const Matrix<double> seen = some_observations(setup.plant->spec(), 8);

  const Matrix<double> a = first_actions(*si, setup, seen), b = first_actions(*own, setup, seen);

  for (std::size_t lane = 0; lane < 8; ++lane) CHECK(a.at(0, lane) == doctest::Approx(b.at(0, lane)).epsilon(1e-12));
}

TEST_CASE("a lane begins anew at step 0 and leaves the others alone") {
  const Setup setup = cartpole();
  const auto source = source_of("kind = \"pid\"\nof = \"theta\"\nkp = -50\nki = -5\nkd = -9", setup);
  const std::unique_ptr<Policy> both = source->make(setup, {}), alone = source->make(setup, {});
  Matrix<double> seen(4, 2, 0.125), one(4, 1, 0.125), action(1, 2), single(1, 1);

  both->act(seen.view(), std::vector<std::int64_t>{0, 0}, action.view());
  alone->act(one.view(), std::vector<std::int64_t>{0}, single.view());
  const double first = single.at(0, 0);
  seen.at(2, 0) = seen.at(2, 1) = one.at(2, 0) = 0.25;
  both->act(seen.view(), std::vector<std::int64_t>{1, 1}, action.view());
  seen.at(2, 1) = 0.125;
  both->act(seen.view(), std::vector<std::int64_t>{2, 0}, action.view());  // the second lane's episode has ended
  alone->act(one.view(), std::vector<std::int64_t>{1}, single.view());
  alone->act(one.view(), std::vector<std::int64_t>{2}, single.view());

  CHECK(action.at(0, 0) == single.at(0, 0));
  CHECK(action.at(0, 1) == first);
}

TEST_CASE("a loop that cannot be is told with its place and what would be right") {
  const Setup setup = cartpole();
  const std::pair<std::string, std::string> mistakes[] = {
      {"kp = 1", "study.toml:1:1: a loop of a pid policy needs 'of'; choose from x, x_dot, theta, theta_dot"},
      {"of = \"thata\"\nkp = 1", "study.toml:2:6: 'of': unknown component 'thata'; did you mean 'theta'?"},
      {"of = \"theta\"\nto = \"forse\"\nkp = 1",
       "study.toml:3:6: 'to': unknown component 'forse'; did you mean 'force'?"},
      {"of = \"theta\"", "study.toml:1:1: the loop of theta does nothing; give it a 'kp', 'ki' or 'kd'"},
      {"of = \"theta\"\nkp = 1\nlow = 2\nhigh = -2", "'low' must be less than 'high', got 2 and -2"},
      {"of = \"theta\"\nkp = 1\nfilter = -0.1", "study.toml:4:10: 'filter' must be >= 0, got -0.1"},
      {"of = \"theta\"\nkp = nan", "study.toml:3:6: 'kp' must be a finite number, got nan"},
      {"of = \"theta\"\nkp = 1\nwindup = \"clam\"",
       "study.toml:4:10: 'windup' must be one of clamp, back, none, got 'clam'; did you mean"},
      {"of = \"theta\"\nkp = -1\nki = 1\nwindup = \"back\"",
       "windup = \"back\" needs a 'tracking' > 0, since kp / ki is -1"},
      {"of = \"x\"\nto = \"theta\"\nkp = 1", "no loop is of theta, whose reference this one gives"},
      {"loops = []", "study.toml:2:9: 'loops' must have at least one loop"},
      {"kp = 1\nloops = [{ of = \"x\", kp = 1 }]", "study.toml:3:9: the keys of one loop stand beside 'loops'"},
      {"loops = [{ of = \"theta\", kp = 1 }, { of = \"x\", to = \"theta\", kp = 1 }]",
       "study.toml:2:10: the loop of theta must come after the one that gives its reference"},
      {"loops = [{ of = \"x\", kp = 1, gain = 2 }]",
       "study.toml:2:37: unknown key 'gain' in a loop of a policy of kind pid"},
      {"loops = [{ of = \"x\", kp = 1 }, { of = \"x\", kd = 1 }]",
       "study.toml:2:32: two loops are of x to the same output"},
      {"k = [[1, 2, 3, 4]]", "study.toml:2:5: unknown key 'k' in a policy of kind pid"},
  };
  for (const auto& [text, wanted] : mistakes) {
    CAPTURE(text);
    const std::string told = complaint_about("kind = \"pid\"\n" + text, setup);
    CAPTURE(told);
    CHECK(told.find(wanted) != std::string::npos);
    CHECK(told.find('\n') == std::string::npos);
  }
}
