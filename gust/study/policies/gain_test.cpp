#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "gust/control/lqr.h"
#include "gust/eval/evaluate.h"
#include "gust/study/policies/policy_fixture_test.h"

using namespace gust;
using namespace gust::test;

namespace {

const std::string kCartpole = "kind = \"cartpole\"";

/// The rows of a matrix as TOML, every column times a number.
std::string toml(const Eigen::MatrixXd& matrix, const std::vector<double>& factors = {}) {
  std::vector<std::string> rows;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    std::vector<std::string> row;
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      row.push_back(format("{:.17e}", matrix(i, j) * (factors.empty() ? 1.0 : factors[static_cast<std::size_t>(j)])));
    rows.push_back(cat("[", join(row, ", "), "]"));
  }
  return cat("[", join(rows, ", "), "]");
}

/// The greatest difference of two policies' states through episodes from random starts.
double apart(const PolicySource& a, const PolicySource& b, const Setup& setup) {
  const Interface& spec = setup.plant->spec();
  const Evaluation evaluation{.source = setup.plant.object.get(),
                              .injections = {},
                              .cells = {{{}, nominal_parameters(spec)}},
                              .starts = {random_starts()},
                              .episodes = 3,
                              .root = Rng(1)};
  double greatest = 0;
  for (std::int64_t episode = 0; episode < evaluation.episodes; ++episode) {
    const Trace one = trace_episode(evaluation, *a.make(setup, {}), {0, 0, episode});
    const Trace other = trace_episode(evaluation, *b.make(setup, {}), {0, 0, episode});
    for (std::size_t i = 0; i < one.state.rows(); ++i) {
      for (std::size_t k = 0; k < one.state.lanes(); ++k)
        greatest = std::max(greatest, std::abs(one.state.at(i, k) - other.state.at(i, k)));
    }
    CHECK(one.failed_at == -1);
  }
  return greatest;
}

Eigen::MatrixXd scipy_gain() {
  std::ifstream file(std::string(GUST_TEST_DATA) + "/reference/lqr/lqr.json");
  const nlohmann::json entry = nlohmann::json::parse(file).at("cartpoles").at(0);
  Eigen::MatrixXd gain(1, 4);
  for (Eigen::Index j = 0; j < 4; ++j)
    gain(0, j) = entry.at("gain").at(0).at(static_cast<std::size_t>(j)).get<double>();
  return gain;
}

}  // namespace

TEST_CASE("SciPy's gain of the cart-pole gives the closed loop of the regulator") {
  const Setup setup = setup_of(kCartpole);
  const auto lqr = source_of("kind = \"lqr\"\nq = [5, 0.1, 1, 0.1]\nr = [1e-4]", setup);
  const auto scipy = source_of(cat("kind = \"gain\"\nk = ", toml(scipy_gain())), setup);
  const auto own = source_of(
      cat("kind = \"gain\"\nk = ", toml(lqr_gain(setup.equations("lqr", {}), {{5, 0.1, 1, 0.1}, {1e-4}}))), setup);

  CHECK(apart(*lqr, *scipy, setup) < 1e-8);  // the Riccati equation's condition is about 1e6
  CHECK(apart(*lqr, *own, setup) == 0.0);
}

TEST_CASE("a gain in degrees, percent and another order is the same policy") {
  const Setup setup = setup_of(kCartpole);
  constexpr double kPerDegree = std::numbers::pi / 180;
  const Eigen::MatrixXd k = scipy_gain();
  const auto si = source_of(cat("kind = \"gain\"\nk = ", toml(k)), setup);
  const auto degrees = source_of(cat("kind = \"gain\"\nk = ", toml(k, {1, 1, kPerDegree, kPerDegree}),
                                     "\nunits = { theta = \"deg\", theta_dot = \"deg/s\" }"),
                                 setup);
  const auto percent = source_of(cat("kind = \"gain\"\nk = ", toml(k, {10, 10, 10, 10}), "\nunits = \"%\""), setup);
  Eigen::MatrixXd turned(1, 4);
  turned << -k(0, 2), k(0, 3) * kPerDegree, k(0, 0) / 100, k(0, 1);
  const auto other = source_of(
      cat("kind = \"gain\"\nk = ", toml(turned), "\nobserve = [\"-theta\", \"theta_dot=deg/s\", \"x=cm\", \"x_dot\"]"),
      setup);

  for (const auto& source : {degrees, percent, other}) CHECK(apart(*si, *source, setup) < 1e-12);
}

TEST_CASE("a gain in a CSV file is the one in the study, with or without the names of its columns") {
  const Setup setup = setup_of(kCartpole);
  const std::string policy = "kind = \"gain\"\nfile = \"k.csv\"";
  const std::string wanted = source_of("kind = \"gain\"\nk = [[1.5, 2, 30, 4]]", setup)->canonical({});

  CHECK(wanted == "gain k [[1.5, 2, 30, 4]] u0 [0]\n");
  for (const std::string text : {"1.5,2,30,4\n", "# saved by numpy\n1.5, 2.0, 3e1, +4\r\n\r\n",
                                 "x,x_dot,theta,theta_dot\n1.5,2,30,4", "theta,theta_dot,x,x_dot\n30,4,1.5,2\n",
                                 "\xEF\xBB\xBF"
                                 "1.5,2,30,4"}) {
    CAPTURE(text);
    CHECK(source_of(policy, setup, {{"k.csv", text}})->canonical({}) == wanted);
  }
}

TEST_CASE("a gain acts about the reference, and about the action that holds it unless the study says another") {
  const Setup setup = setup_of("kind = \"quadrotor\"");
  const PlantSpec& spec = setup.equations("lqr", {}).spec();
  Matrix<double> seen(spec.observations(), 1);
  std::vector<double> goal(spec.state.size());
  setup.equations("lqr", {}).reference(0, goal);
  for (std::size_t i = 0; i < goal.size(); ++i) seen.at(i, 0) = goal[i];
  const std::string zeros = "kind = \"gain\"\nk = [[0,0,0,0,0,0],[0,0,0,0,0,0]]";

  const Matrix<double> rest = first_actions(*source_of(zeros, setup), setup, seen);
  const Matrix<double> given = first_actions(*source_of(zeros + "\nu0 = [0.1, 0.2]", setup), setup, seen);

  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(spec.action_offset[i] + spec.action_scale[i] * rest.at(i, 0) ==
          doctest::Approx(spec.action_goal[i]).epsilon(1e-14));
    CHECK(spec.action_offset[i] + spec.action_scale[i] * given.at(i, 0) ==
          doctest::Approx(0.1 * static_cast<double>(i + 1)).epsilon(1e-14));
  }
}

TEST_CASE("a gain aims at a moving reference as a cascade does") {
  const Setup setup = setup_of("kind = \"quadrotor\"");
  const Plant& plant = setup.equations("lqr", {});
  REQUIRE(plant.spec().references > 1);
  const Eigen::MatrixXd k = lqr_gain(plant, reward_weights(plant.spec()));
  const auto source = source_of(cat("kind = \"gain\"\nk = ", toml(k)), setup);
  const auto seen = some_observations(setup.plant->spec(), 1);
  const std::int64_t steps[] = {40};
  Matrix<double> ours(2, 1), theirs(2, 1);

  source->make(setup, {})->act(seen.view(), steps, ours.view());
  feedback_policy(plant, k)->act(seen.view(), steps, theirs.view());

  for (std::size_t i = 0; i < 2; ++i) CHECK(ours.at(i, 0) == theirs.at(i, 0));
}

TEST_CASE("a gain that does not fit is told with its place and what would fit") {
  const Setup setup = setup_of(kCartpole);
  const std::pair<std::string, std::string> mistakes[] = {
      {"", "study.toml:1:1: a gain policy needs a 'k', such as [[-1, -2, 20, 4]], or a 'file'"},
      {"k = [[1, 2, 3]]",
       "study.toml:2:6: K must be 1 x 4, a row for each action and a column for each of x, x_dot, theta, "
       "theta_dot; this row has 3 numbers"},
      {"k = [[1, 2, 3, 4], [1, 2, 3, 4]]", "; got 2 rows"},
      {"k = [[1, 2, nan, 4]]", "study.toml:2:13: 'k' must be a finite number, got nan"},
      {"k = [[1, 2, \"3\", 4]]", "study.toml:2:13: 'k' must be a number, got text"},
      {"k = 3", "study.toml:2:5: 'k' must be a list, got a whole number"},
      {"k = [[1, 2, 3, 4]]\nunits = { thta = \"deg\" }",
       "study.toml:3:18: 'units': unknown component 'thta'; did you mean 'theta'?"},
      {"k = [[1, 2, 3, 4]]\nunits = { theta = \"dge\" }",
       "study.toml:3:19: 'dge' is no unit of theta [rad]; did you mean 'deg'?"},
      {"k = [[1, 2, 3, 4]]\nunits = \"Nm\"", "study.toml:3:9: 'Nm' is no unit of the action force [N]"},
      {"k = [[1, 2, 3, 4]]\nu0 = [1, 2]", "study.toml:3:6: 'u0' must have 1 number (force), got 2"},
      {"k = [[1, 2]]\nobserve = [\"theta\", \"thata_dot\"]",
       "study.toml:3:21: 'observe': unknown component 'thata_dot'; did you mean"},
      {"k = [[1, 2]]\nobserve = [\"theta\", \"sin theta\"]",
       "study.toml:3:11: 'observe' of a gain policy must be states"},
      {"k = [[1]]\nobserve = [\"theta=deg\"]\nunits = { theta = \"deg\" }",
       "study.toml:4:9: the unit of theta stands in 'observe' and in 'units'"},
      {"file = \"missing.csv\"", "study.toml:2:8: no file matches 'missing.csv'"},
      {"file = \"k.csv\"\nk = [[1, 2, 3, 4]]", "study.toml:2:8: 'k' and 'file' say the same"},
      {"file = \"k.csv\"", "k.csv:2:4: K must be numbers with commas between, got 'two'"},
      {"file = \"nan.csv\"", "nan.csv:1:3: K must be finite numbers, got nan"},
      {"file = \"short.csv\"",
       "short.csv:2:1: K must be 1 x 2, a row for each action and a column for each of theta, x; this row has 1 "
       "number"},
      {"file = \"empty.csv\"", "empty.csv:1:1: K must be 1 x 4"},
      {"file = \"spaces.csv\"", "spaces.csv:1:1: K must be numbers with commas between, got '1 2 3 4'"},
      {"file = \"names.csv\"", "names.csv:1:3: 'observe': unknown component 'speed'"},
      {"kp = 3", "study.toml:2:6: unknown key 'kp' in a policy of kind gain"},
  };
  const std::vector<StudyFile> files = {
      {"k.csv", "# a\n1, two,3,4\n"}, {"nan.csv", "1,nan,3,4\n"}, {"names.csv", "x,speed\n1,2\n"},
      {"short.csv", "theta,x\n1\n"},  {"empty.csv", ""},          {"spaces.csv", "1 2 3 4\n"}};
  for (const auto& [text, wanted] : mistakes) {
    CAPTURE(text);
    const std::string told = complaint_about("kind = \"gain\"\n" + text, setup, files);
    CAPTURE(told);
    CHECK(told.find(wanted) != std::string::npos);
    CHECK(told.find('\n') == std::string::npos);
  }
}
