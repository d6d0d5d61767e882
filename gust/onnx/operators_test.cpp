#include "gust/onnx/operators.h"

#include <doctest/doctest.h>

#include <vector>

#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

/// action = obs times weights; the weights are (1, 10, 100) and its negative.
OnnxFixture product(const std::string& op, const std::vector<std::string>& inputs = {"obs", "w"}) {
  OnnxFixture file;
  file.floats("w", {3, 2}, {1, -1, 10, -10, 100, -100});
  file.node(op, inputs, "action");
  return file;
}

}  // namespace

TEST_CASE("Gemm is alpha A B + beta C") {
  CHECK(act(product("Gemm"), {1, 2, 3}) == std::vector<float>{321, -321});

  OnnxFixture file = product("Gemm", {"obs", "w", "c"});
  onnx::NodeProto& node = *file.graph().mutable_node(0);
  file.floats("c", {2}, {1, 2});
  CHECK(act(file, {1, 2, 3}) == std::vector<float>{322, -319});

  set(node, "alpha", 2.0f);
  set(node, "beta", 0.5f);
  CHECK(act(file, {1, 2, 3, 0, 0, 1}) == std::vector<float>{642.5f, -641, 200.5f, -199});
}

TEST_CASE("Gemm transposes its weights, and constants on the left") {
  OnnxFixture file;
  file.floats("w", {2, 3}, {1, 10, 100, -1, -10, -100});
  set(file.node("Gemm", {"obs", "w"}, "action"), "transB", std::int64_t{1});
  CHECK(act(file, {1, 2, 3}) == std::vector<float>{321, -321});

  OnnxFixture both;
  both.floats("left", {1, 3}, {1, 2, 3});
  both.floats("right", {1, 2}, {10, 100});
  set(both.node("Gemm", {"left", "right"}, "w"), "transA", std::int64_t{1});
  both.node("MatMul", {"obs", "w"}, "action");
  CHECK(act(both, {1, 1, 1}) == std::vector<float>{60, 600});
}

TEST_CASE("Gemm with a factor of zero leaves its summand out, whatever it holds") {
  OnnxFixture file = product("Gemm", {"obs", "w", "c"});
  file.floats("c", {1}, {INFINITY});
  set(*file.graph().mutable_node(0), "beta", 0.0f);

  CHECK(act(file, {1, 0, 0}) == std::vector<float>{1, -1});
}

TEST_CASE("MatMul takes a matrix or a vector") {
  CHECK(act(product("MatMul"), {1, 2, 3}) == std::vector<float>{321, -321});

  OnnxFixture vector;
  vector.floats("w", {3}, {1, 10, 100});
  vector.node("MatMul", {"obs", "w"}, "action");
  CHECK(act(vector, {1, 2, 3, 0, 0, 1}) == std::vector<float>{321, 100});
}

TEST_CASE("products that do not fit, or would mix the lanes, are refused") {
  OnnxFixture wrong({0, 4});
  wrong.floats("w", {3, 2}, {1, 2, 3, 4, 5, 6});
  wrong.node("Gemm", {"obs", "w"}, "action");
  CHECK(refusal(wrong).find("multiplies 4 numbers with weights for 3") != std::string::npos);

  OnnxFixture mixed = product("Gemm");
  set(*mixed.graph().mutable_node(0), "transA", std::int64_t{1});
  CHECK(refusal(mixed).find("across the batch") != std::string::npos);

  OnnxFixture lanes;
  lanes.node("Transpose", {"obs"}, "columns");
  lanes.node("MatMul", {"obs", "columns"}, "action");
  CHECK(refusal(lanes).find("different lanes of the batch") != std::string::npos);

  OnnxFixture left;
  left.floats("w", {2, 3}, {1, 2, 3, 4, 5, 6});
  left.node("MatMul", {"w", "obs"}, "action");
  CHECK(refusal(left).find("across the batch") != std::string::npos);

  OnnxFixture bias = product("Gemm", {"obs", "w", "c"});
  bias.floats("c", {3}, {1, 2, 3});
  CHECK(refusal(bias).find("different shapes") != std::string::npos);
}

TEST_CASE("Clip takes its bounds as inputs, each of which may be left out") {
  const auto clipped = [](const std::vector<std::string>& inputs) {
    OnnxFixture file;
    file.floats("low", {}, {-1});
    file.floats("high", {1}, {2});
    file.floats("list", {2}, {1, 2});
    file.node("Clip", inputs, "action");
    return file;
  };

  CHECK(act(clipped({"obs", "low", "high"}), {-5, 0, 5}) == std::vector<float>{-1, 0, 2});
  CHECK(act(clipped({"obs", "", "high"}), {-5, 0, 5}) == std::vector<float>{-5, 0, 2});
  CHECK(act(clipped({"obs", "low"}), {-5, 0, 5}) == std::vector<float>{-1, 0, 5});
  CHECK(act(clipped({"obs"}), {-5, 0, 5}) == std::vector<float>{-5, 0, 5});
  CHECK(refusal(clipped({"obs", "obs"})).find("takes bounds that depend on the observation") != std::string::npos);
  CHECK(refusal(clipped({"obs", "list"})).find("a bound that is not one number") != std::string::npos);
}

TEST_CASE("Clip may be open to infinity") {
  OnnxFixture file;
  file.floats("low", {}, {-INFINITY});
  file.floats("high", {}, {INFINITY});
  file.node("Clip", {"obs", "low", "high"}, "action");

  CHECK(act(file, {-5, 0, 5}) == std::vector<float>{-5, 0, 5});
}

TEST_CASE("arithmetic keeps the order of its operands") {
  const std::vector<std::pair<std::string, std::vector<float>>> expected = {
      {"Sub", {7, 6, 4}}, {"Div", {8, 4, 2}}, {"Min", {1, 2, 4}}, {"Max", {8, 8, 8}}};
  for (const auto& [op, values] : expected) {
    OnnxFixture file;
    file.floats("eight", {}, {8});
    file.node(op, {"eight", "obs"}, "action");
    CHECK(act(file, {1, 2, 4}) == values);
  }
}

TEST_CASE("Min and Max take any number of inputs") {
  OnnxFixture file;
  file.floats("a", {3}, {0, 5, 1});
  file.floats("b", {}, {3});
  file.node("Max", {"obs", "a", "b"}, "action");

  CHECK(act(file, {4, 1, 2}) == std::vector<float>{4, 5, 3});
}

TEST_CASE("functions take their slope from the node or from the standard") {
  OnnxFixture leaky;
  leaky.node("LeakyRelu", {"obs"}, "action");
  CHECK(act(leaky, {-1, 0, 1}) == std::vector<float>{-0.01f, 0, 1});

  set(*leaky.graph().mutable_node(0), "alpha", 0.5f);
  CHECK(act(leaky, {-1, 0, 1}) == std::vector<float>{-0.5f, 0, 1});

  OnnxFixture negated;
  negated.node("Neg", {"obs"}, "action");
  CHECK(act(negated, {-1, 0.5f, 1}) == std::vector<float>{1, -0.5f, -1});
}

TEST_CASE("the list of operators is in order and complete") {
  const std::string names = onnx_operator_names();

  for (const char* name : {"Add", "Cast", "Clip", "Constant", "Div", "Flatten", "Gemm", "Identity", "MatMul", "Mul",
                           "Relu", "Sub", "Tanh"}) {
    CHECK(find_onnx_operator(name) != nullptr);
    CHECK(names.find(name) != std::string::npos);
  }
  CHECK(find_onnx_operator("gemm") == nullptr);
}

TEST_CASE("a constant matrix may stand on the left, and both factors may depend on the observation") {
  OnnxFixture gain;
  gain.floats("k", {2, 3}, {1, 10, 100, -1, -10, -100});
  gain.node("Transpose", {"obs"}, "columns");
  gain.node("MatMul", {"k", "columns"}, "forces");
  gain.node("Transpose", {"forces"}, "action");
  CHECK(act(gain, {1, 2, 3, 0, 0, 1}) == std::vector<float>{321, -321, 100, -100});

  OnnxFixture square;
  square.integers("second", {1});
  square.integers("third", {2});
  square.node("Unsqueeze", {"obs", "second"}, "row");
  square.node("Unsqueeze", {"obs", "third"}, "column");
  square.node("MatMul", {"row", "column"}, "action");
  CHECK(act(square, {1, 2, 3, 0, 0, 2}) == std::vector<float>{14, 4});
}
