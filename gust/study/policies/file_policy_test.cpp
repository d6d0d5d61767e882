#include "gust/study/policies/file_policy.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gust/core/rng.h"
#include "gust/onnx/onnx.h"

namespace gust {
namespace {

const std::vector<std::int64_t> kFirst(200, 0);  // every lane before its first step

Setup cartpole() {
  Table plant;
  plant.set("kind", {std::string("cartpole"), {}});
  return make_setup(plant);
}

/// A linear policy whose action is the sum of its inputs, times two.
std::string policy_file(std::size_t inputs, const OnnxMetadata& metadata = {}, std::size_t outputs = 1) {
  Mlp<float> mlp(MlpShape{.sizes = {inputs, outputs}});
  for (std::size_t i = 0; i < inputs; ++i) mlp.weight(0, 0, i) = 2.0f;
  return write_onnx({mlp}, metadata);
}

std::string error_of(const std::string& bytes) {
  try {
    onnx_policy(bytes, "p.onnx", cartpole());
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST_CASE("an ONNX policy sees the observation in float32 and leaves its action as it is") {
  const auto policy = onnx_policy(policy_file(4), "p.onnx", cartpole());
  Matrix<double> observation(4, 3);
  observation.at(0, 0) = 100.0;
  observation.at(1, 1) = 0.1;
  observation.at(3, 2) = std::numeric_limits<double>::quiet_NaN();
  Matrix<double> action(1, 3);

  policy->act(observation.view(), kFirst, action.view());

  CHECK(action.at(0, 0) == 200.0);
  CHECK(action.at(0, 1) == 2.0 * static_cast<double>(0.1f));
  CHECK(std::isnan(action.at(0, 2)));
}

/// A network with two hidden layers of 64 and normal weights.
std::string random_policy_file() {
  Mlp<float> mlp(MlpShape{.sizes = {4, 64, 64, 1}});
  const Rng rng(1);
  for (std::size_t i = 0; i < mlp.parameters().size(); ++i) mlp.parameters()[i] = static_cast<float>(rng.normal(i));
  return write_onnx({mlp}, {});
}

Matrix<double> random_observations(std::size_t lanes) {
  Matrix<double> observation(4, lanes);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t lane = 0; lane < lanes; ++lane) observation.at(i, lane) = Rng(2).normal(i * lanes + lane);
  }
  return observation;
}

TEST_CASE("an ONNX policy acts on a lane as if it were alone, in float and in double") {
  constexpr std::size_t kLanes = 131;
  const Matrix<double> observation = random_observations(kLanes);
  for (const Arithmetic arithmetic : {Arithmetic::kFloat, Arithmetic::kDouble}) {
    const auto policy = onnx_policy(random_policy_file(), "p.onnx", cartpole(), {.arithmetic = arithmetic});
    Matrix<double> together(1, kLanes);
    policy->act(observation.view(), kFirst, together.view());

    bool equal = true;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      Matrix<double> one(4, 1), action(1, 1);
      for (std::size_t i = 0; i < 4; ++i) one.at(i, 0) = observation.at(i, lane);
      policy->act(one.view(), kFirst, action.view());
      equal = equal && action.at(0, 0) == together.at(0, lane);
    }

    CHECK(equal);
  }
}

TEST_CASE("an ONNX policy in float differs from that in double by float's rounding alone") {
  constexpr std::size_t kLanes = 64;
  const Matrix<double> observation = random_observations(kLanes);
  Matrix<double> single(1, kLanes), wide(1, kLanes);

  onnx_policy(random_policy_file(), "p", cartpole(), {.arithmetic = Arithmetic::kFloat})
      ->act(observation.view(), kFirst, single.view());
  onnx_policy(random_policy_file(), "p", cartpole(), {.arithmetic = Arithmetic::kDouble})
      ->act(observation.view(), kFirst, wide.view());

  double worst = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    worst = std::max(worst, std::abs(single.at(0, lane) - wide.at(0, lane)));
  }
  CHECK(worst > 0);
  CHECK(worst < 1e-4);  // the sum over 64 activations with normal weights is about 8; tanh in float is within 5e-7
}

TEST_CASE("an ONNX policy that does not fit the plant is an error that names the file") {
  CHECK(error_of(policy_file(6)) ==
        "p.onnx: the policy takes 6 numbers; the plant cartpole is observed by 4 (x, x_dot, theta, theta_dot); "
        "'observe' says which of them it takes");
  CHECK(error_of(policy_file(4, {}, 3)) == "p.onnx: the policy gives 3 numbers; the plant cartpole takes 1 (force)");
  CHECK(error_of(policy_file(4, {}, 2)) ==
        "p.onnx: the policy gives 2 numbers, twice the 1 that the plant cartpole takes (force): probably the mean and "
        "the "
        "log-deviation of the action, joined. Export the mean alone (output[:, :1] of the network), or choose another "
        "output of the file");
  CHECK(error_of("no protobuf").substr(0, 8) == "p.onnx: ");
}

TEST_CASE("metadata of a policy must not contradict the setup, and may be missing") {
  CHECK(error_of(policy_file(4)) == "no error");
  CHECK(error_of(policy_file(4, {{"gust.plant", "cartpole"}, {"gust.preset", "scg-2022"}, {"author", "me"}})) ==
        "no error");
  CHECK(error_of(policy_file(4, {{"gust.preset", "scg-default"}})) ==
        "p.onnx: the policy was made for the preset 'scg-default' (gust.preset in its metadata), not for 'scg-2022'");
  CHECK(error_of(policy_file(4, {{"gust.plant", "quadrotor"}})).find("for the plant 'quadrotor'") != std::string::npos);
  CHECK(error_of(policy_file(4, {{"gust.units", "N"}})).find("for the action unit 'N'") != std::string::npos);
}

TEST_CASE("a unit that nobody says is told under normalised actions, with what speaks against it") {
  const OnnxMetadata ours = {{"gust.plant", "cartpole"}, {"gust.units", "normalised"}};
  const FilePolicy silent = file_policy(policy_file(4), "p.onnx", cartpole());
  const FilePolicy own = file_policy(policy_file(4, ours), "p.onnx", cartpole());
  const FilePolicy said = file_policy(policy_file(4), "p.onnx", cartpole(), {.interface = {.says_unit = true}});
  Mlp<float> gain(MlpShape{.sizes = {4, 1}});
  for (std::size_t i = 0; i < 4; ++i) gain.weight(0, 0, i) = 200.0f;  // at most 80 for starts of 0.3 m and 0.1 rad
  const FilePolicy strong = file_policy(write_onnx({gain}, {}), "p.onnx", cartpole());

  CHECK(silent.foreign);
  CHECK(silent.unit_warning ==
        "p.onnx does not say the unit of its actions: they are taken as normalised (force = 10 N times action). Say "
        "units = \"normalised\" or units = \"N\" (--units)");
  CHECK_FALSE(own.foreign);
  CHECK(own.unit_warning.empty());
  CHECK(said.foreign);
  CHECK(said.unit_warning.empty());
  CHECK(strong.unit_warning.find("; of 100 actions at random starts ") != std::string::npos);
  CHECK(strong.unit_warning.find("lie beyond -1 to 1") != std::string::npos);
}

}  // namespace
}  // namespace gust
