#include "gust/onnx/onnx.h"

#include <doctest/doctest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

std::string reference(const std::string& path) {
  std::ifstream file(GUST_TEST_DATA "/reference/" + path, std::ios::binary);
  GUST_CHECK(file.good());
  return {std::istreambuf_iterator<char>(file), {}};
}

/// obs -> Gemm -> activation -> Gemm -> action, with the identity in both layers and biases of (1, 2, 3).
OnnxFixture chain(const std::string& activation) {
  OnnxFixture file;
  file.floats("w", {3, 3}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  file.floats("b", {3}, {1, 2, 3});
  file.node("Gemm", {"obs", "w", "b"}, "sums");
  file.node(activation, {"sums"}, "hidden");
  file.node("Gemm", {"hidden", "w", "b"}, "action");
  return file;
}

}  // namespace

TEST_CASE("the reference policies are read as networks of 64 x 64 tanh") {
  for (const char* name : {"scg-2022-ppo-s1", "scg-default-ppo-s1"}) {
    const OnnxModel model = read_onnx(reference(cat("scg_policies/", name, ".onnx")), name);

    REQUIRE(model.actor);
    CHECK(model.actor->mlp.shape() == MlpShape{.sizes = {4, 64, 64, 1}, .activation = Activation::kTanh});
    CHECK(model.observations() == 4);
    CHECK(model.actions() == 1);
    CHECK(model.metadata.empty());
  }
}

TEST_CASE("exports of Stable-Baselines3 are read without their value and log-probability") {
  const OnnxModel ppo = read_onnx(reference("sb3_policies/ppo.onnx"), "ppo.onnx", {.output = "53"});
  REQUIRE(ppo.actor);
  CHECK(ppo.actor->mlp.shape() == MlpShape{.sizes = {4, 64, 64, 1}, .activation = Activation::kTanh});

  const OnnxModel sac = read_onnx(reference("sb3_policies/sac.onnx"), "sac.onnx");
  REQUIRE(sac.actor);  // a tanh follows the last layer
  CHECK(sac.actor->box == ActionBox{{0}, {1}});
  CHECK(sac.program.steps.size() == 6);
}

TEST_CASE("a chain of layers with one activation is found to be one") {
  CHECK(read_onnx(chain("Tanh").bytes(), "x").actor->mlp.shape().activation == Activation::kTanh);
  CHECK(read_onnx(chain("Relu").bytes(), "x").actor->mlp.shape().activation == Activation::kRelu);
  CHECK(read_onnx(chain("LeakyRelu").bytes(), "x").actor->mlp.shape().activation == Activation::kLeakyRelu);
  CHECK_FALSE(read_onnx(chain("Sigmoid").bytes(), "x").actor);

  OnnxFixture other_slope = chain("LeakyRelu");
  set(*other_slope.graph().mutable_node(1), "alpha", 0.2f);
  CHECK_FALSE(read_onnx(other_slope.bytes(), "x").actor);

  OnnxFixture shortcut = chain("Relu");
  shortcut.graph().mutable_node(2)->set_output(0, "sum");
  shortcut.node("Add", {"sum", "hidden"}, "action");
  CHECK_FALSE(read_onnx(shortcut.bytes(), "x").actor);
  CHECK(act(shortcut, {-5, 0, 1}) == std::vector<float>{1, 6, 11});

  OnnxFixture bent = chain("Relu");
  bent.graph().mutable_node(2)->set_input(0, "sums");
  bent.node("Tanh", {"hidden"}, "unused");
  CHECK_FALSE(read_onnx(bent.bytes(), "x").actor);
}

TEST_CASE("a network of one layer is a chain") {
  OnnxFixture file;
  file.floats("w", {3, 1}, {1, 10, 100});
  file.node("MatMul", {"obs", "w"}, "action");

  CHECK(read_onnx(file.bytes(), "x").actor->mlp.shape().sizes == std::vector<std::size_t>{3, 1});
  CHECK(act(file, {1, 2, 3}) == std::vector<float>{321});
}

TEST_CASE("the chain and the program agree") {
  const OnnxModel model = read_onnx(reference("scg_policies/scg-2022-ppo-s1.onnx"), "x");
  std::vector<float> observations;
  for (int i = 0; i < 4 * 100; ++i) observations.push_back(0.01f * static_cast<float>(i % 37 - 18));
  std::vector<float> fast(100);
  std::vector<float> plain(100);

  OnnxRunner(model).run(observations, 100, fast);
  OnnxProgramRunner(model.program).run(observations, 100, plain);

  // The layers add up in the same order; the hyperbolic tangent of training is a shorter polynomial.
  for (std::size_t i = 0; i < fast.size(); ++i) CHECK(fast[i] == doctest::Approx(plain[i]).epsilon(1e-5).scale(1.0));
}

TEST_CASE("a lane's bits do not depend on the lanes beside it") {
  for (const char* name : {"scg_policies/scg-2022-ppo-s1.onnx", "sb3_policies/sac.onnx"}) {
    const OnnxModel model = read_onnx(reference(name), name);
    std::vector<float> observations;
    for (int i = 0; i < 4 * 150; ++i) observations.push_back(0.1f * static_cast<float>(i % 29 - 14));
    std::vector<float> together(150);
    OnnxRunner(model).run(observations, 150, together);

    OnnxRunner alone(model);
    for (std::size_t lane = 0; lane < 150; ++lane) {
      std::vector<float> one(1);
      alone.run({observations.data() + 4 * lane, 4}, 1, one);
      CHECK(one[0] == together[lane]);
    }
  }
}

TEST_CASE("a policy file that is cut short anywhere, or has a byte changed, never crashes the reader") {
  const std::string bytes = chain("Tanh").bytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) refusal(bytes.substr(0, size));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int change : {1, 0x80, 0xff}) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ change);
      refusal(changed);
    }
  }
  CHECK(refusal(bytes) == "");
}

TEST_CASE("a foreign file that is cut short within its graph is refused") {
  const std::string bytes = reference("sb3_policies/td3.onnx");

  // Its graph is followed by 4 bytes of opset alone.
  for (std::size_t size = 0; size + 4 < bytes.size(); size += 13) CHECK(refusal(bytes.substr(0, size)) != "");
}
