#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "gust/core/rng.h"
#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

Mlp<float> network(MlpShape shape) {
  Mlp<float> mlp(std::move(shape));
  const Rng rng = Rng(7).split("weights");
  std::uint64_t draw = 0;
  for (std::size_t layer = 0; layer < mlp.shape().layers(); ++layer) {
    for (std::size_t output = 0; output < mlp.shape().sizes[layer + 1]; ++output) {
      mlp.bias(layer, output) = static_cast<float>(rng.normal(draw++));
      for (std::size_t input = 0; input < mlp.shape().sizes[layer]; ++input) {
        mlp.weight(layer, output, input) = static_cast<float>(rng.normal(draw++));
      }
    }
  }
  return mlp;
}

}  // namespace

TEST_CASE("a network that is written and read is the same to the bit") {
  for (const auto activation : {Activation::kTanh, Activation::kRelu, Activation::kLeakyRelu}) {
    const Mlp<float> mlp = network({.sizes = {6, 32, 17, 2}, .activation = activation});

    const OnnxModel read = read_onnx(write_onnx({mlp}, {}), "x.onnx");

    REQUIRE(read.actor);
    CHECK(read.actor->mlp.shape() == mlp.shape());
    CHECK(std::ranges::equal(read.actor->mlp.parameters(), mlp.parameters()));
  }
}

TEST_CASE("a network without hidden layers is written and read") {
  const Mlp<float> mlp = network({.sizes = {3, 2}});

  const OnnxModel read = read_onnx(write_onnx({mlp}, {}), "x.onnx");

  REQUIRE(read.actor);
  CHECK(std::ranges::equal(read.actor->mlp.parameters(), mlp.parameters()));
}

TEST_CASE("metadata come back as they were given") {
  const OnnxMetadata metadata = {{"gust.plant", "cartpole"}, {"gust.seed", "3"}, {"note", "two\nlines, µ"}};

  CHECK(read_onnx(write_onnx({network({.sizes = {3, 1}})}, metadata), "x.onnx").metadata == metadata);
}

TEST_CASE("equal networks give equal bytes, of opset 17 with named input and output") {
  const Mlp<float> mlp = network({.sizes = {4, 8, 1}});
  const std::string bytes = write_onnx({mlp}, {{"b", "2"}, {"a", "1"}});

  CHECK(bytes == write_onnx({mlp}, {{"a", "1"}, {"b", "2"}}));

  onnx::ModelProto model;
  REQUIRE(model.ParseFromString(bytes));
  CHECK(model.opset_import(0).version() == 17);
  CHECK(model.graph().input(0).name() == "obs");
  CHECK(model.graph().output(0).name() == "action");
  CHECK(model.graph().node_size() == 3);
}

TEST_CASE("a written policy that is cut short at any byte is refused") {
  const std::string bytes = write_onnx({network({.sizes = {4, 8, 1}})}, {{"gust.plant", "cartpole"}});

  for (std::size_t size = 0; size < bytes.size(); ++size) CHECK(refusal(bytes.substr(0, size)) != "");
  CHECK(refusal(bytes) == "");
}

TEST_CASE("a written policy with weights that are not finite is refused when it is read") {
  Mlp<float> mlp = network({.sizes = {4, 8, 1}});
  mlp.weight(1, 0, 3) = std::numeric_limits<float>::quiet_NaN();

  CHECK(refusal(write_onnx({mlp}, {})).find("infinite or not a number") != std::string::npos);
}

TEST_CASE("a box is written as tanh and what stretches it, and read back") {
  const std::vector<std::pair<ActionBox, int>> boxes = {
      {{{0, 0}, {1, 1}}, 4}, {{{0, 0}, {10, 1}}, 5}, {{{0.5f, -2}, {1, 1}}, 5}, {{{0.5f, -2}, {0.1f, 3}}, 6}};
  for (const auto& [box, nodes] : boxes) {
    const ActorNetwork actor{network({.sizes = {3, 20, 2}, .activation = Activation::kRelu}), box};
    const std::string bytes = write_onnx(actor, {});

    const OnnxModel read = read_onnx(bytes, "x.onnx");

    REQUIRE(read.actor);
    CHECK(read.actor->box == box);
    CHECK(std::ranges::equal(read.actor->mlp.parameters(), actor.mlp.parameters()));
    onnx::ModelProto model;
    REQUIRE(model.ParseFromString(bytes));
    CHECK(model.graph().node_size() == nodes);
  }
}

TEST_CASE("a risk level is an input with a default, at which the file is read, or at another") {
  const ActionBox box{{0}, {1}};
  const ActorNetwork actor{network({.sizes = {4, 20, 1}, .activation = Activation::kRelu}), box, 0.3f};
  const std::string bytes = write_onnx(actor, {});

  const OnnxModel standard = read_onnx(bytes, "x.onnx");
  const OnnxModel other = read_onnx(bytes, "x.onnx", {.alpha = 0.9f});

  CHECK(standard.observations() == 3);
  CHECK(standard.alpha == 0.3f);
  CHECK(other.alpha == 0.9f);
  REQUIRE(standard.actor);
  REQUIRE(other.actor);
  CHECK(std::ranges::equal(standard.actor->mlp.parameters(), at_level(actor, 0.3f).mlp.parameters()));
  CHECK(std::ranges::equal(other.actor->mlp.parameters(), at_level(actor, 0.9f).mlp.parameters()));
  CHECK_THROWS_WITH_AS(read_onnx(write_onnx({network({.sizes = {3, 1}})}, {}), "x.onnx", {.alpha = 0.9f}),
                       "x.onnx: the policy has no input 'alpha'; it acts at one risk level", Error);
}
