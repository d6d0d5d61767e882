#include "gust/onnx/lowering.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

/// action = obs (+) other, where other is a constant of a shape.
OnnxFixture added(const std::vector<std::int64_t>& dims, const std::vector<float>& values) {
  OnnxFixture file;
  file.floats("other", dims, values);
  file.node("Add", {"obs", "other"}, "action");
  return file;
}

const OnnxProgram lowered(const OnnxFixture& file) {
  return OnnxLowering(read_onnx_graph(file.bytes(), "test.onnx")).program();
}

}  // namespace

TEST_CASE("constants broadcast over the lanes as in numpy") {
  CHECK(act(added({}, {1}), {1, 2, 3, 4, 5, 6}) == std::vector<float>{2, 3, 4, 5, 6, 7});
  CHECK(act(added({1}, {1}), {1, 2, 3}) == std::vector<float>{2, 3, 4});
  CHECK(act(added({3}, {1, 2, 3}), {1, 2, 3, 4, 5, 6}) == std::vector<float>{2, 4, 6, 5, 7, 9});
  CHECK(act(added({1, 3}, {1, 2, 3}), {1, 2, 3}) == std::vector<float>{2, 4, 6});
}

TEST_CASE("a value with one column broadcasts over another's columns") {
  OnnxFixture file;
  file.integers("first", {0});
  auto& gather = file.node("Gather", {"obs", "first"}, "column");
  set(gather, "axis", std::int64_t{1});
  file.node("Mul", {"column", "obs"}, "action");

  CHECK(act(file, {2, 3, 4, 5, 6, 7}) == std::vector<float>{4, 6, 8, 25, 30, 35});
}

TEST_CASE("shapes that do not fit, or would mix the lanes, are refused") {
  CHECK(refusal(added({2}, {1, 2})).find("different shapes") != std::string::npos);
  CHECK(refusal(added({2, 3}, {1, 2, 3, 4, 5, 6})).find("different lanes") != std::string::npos);
  CHECK(refusal(added({2, 1, 3}, {1, 2, 3, 4, 5, 6})).empty());  // [2, N, 3]: each lane still by itself
}

TEST_CASE("what depends on constants alone is computed once") {
  OnnxFixture file;
  file.floats("low", {3}, {-1, -2, -3});
  file.floats("high", {1}, {3});
  file.node("Sub", {"high", "low"}, "range");
  file.node("Relu", {"range"}, "positive");
  file.node("Mul", {"obs", "positive"}, "action");

  CHECK(lowered(file).steps.size() == 1);
  CHECK(act(file, {1, 1, 1}) == std::vector<float>{4, 5, 6});
}

TEST_CASE("weights that are not finite are refused where they are used") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  CHECK(refusal(added({}, {nan})).find("node 'the Add' of type 'Add': has weights that are infinite") !=
        std::string::npos);
  CHECK(refusal(added({}, {-infinity})) != "");

  OnnxFixture overflow;
  auto& wide = overflow.floats("w", {3, 1}, {});
  wide.set_data_type(onnx::TensorProto::DOUBLE);
  for (const double value : {1.0, 1e300, 2.0}) wide.add_double_data(value);
  overflow.node("MatMul", {"obs", "w"}, "action");
  CHECK(refusal(overflow).find("infinite") != std::string::npos);

  OnnxFixture unused = added({}, {1.0f});
  unused.floats("spare", {}, {nan});
  CHECK(refusal(unused) == "");
}

TEST_CASE("an infinite constant may bound or replace a number, and is no weight") {
  OnnxFixture file;
  file.floats("low", {}, {-INFINITY});
  file.floats("none", {}, {NAN});
  file.node("Max", {"obs", "low"}, "bounded");
  file.node("Greater", {"bounded", "low"}, "positive");
  file.node("Where", {"positive", "bounded", "none"}, "action");
  CHECK(act(file, {-1, 0, 1}) == std::vector<float>{-1, 0, 1});

  file.graph().mutable_node(0)->set_op_type("Add");
  CHECK(refusal(file).find("infinite or not a number") != std::string::npos);
}

TEST_CASE("an operator that is not supported is named with its node and what is supported") {
  OnnxFixture file;
  file.node("TopK", {"obs"}, "action");
  const std::string message = refusal(file);
  CHECK(message.find(
            "test.onnx: node 'the TopK' of type 'TopK': this operator is not supported; supported are Abs, ") == 0);

  OnnxFixture foreign;
  foreign.node("Relu", {"obs"}, "action").set_domain("com.example");
  CHECK(refusal(foreign).find("not supported") != std::string::npos);
}

TEST_CASE("nodes with too few, too many or empty inputs are refused") {
  OnnxFixture one;
  one.node("Add", {"obs"}, "action");
  CHECK(refusal(one).find("has 1 inputs; this operator takes 2 to 2") != std::string::npos);

  OnnxFixture three;
  three.node("Tanh", {"obs", "obs"}, "action");
  CHECK(refusal(three).find("takes 1 to 1") != std::string::npos);

  OnnxFixture empty;
  empty.node("Sub", {"obs", ""}, "action");
  CHECK(refusal(empty).find("lacks its input 2") != std::string::npos);

  OnnxFixture output;
  output.node("Tanh", {"obs"}, "hidden").add_output("mask");
  output.node("Add", {"hidden", "mask"}, "action");
  CHECK(refusal(output).find("'mask', an output that its node does not have") != std::string::npos);
}

TEST_CASE("an attribute of the wrong type is refused") {
  OnnxFixture file;
  set(file.node("LeakyRelu", {"obs"}, "action"), "alpha", std::int64_t{1});

  CHECK(refusal(file).find("attribute 'alpha' has the wrong type") != std::string::npos);
}

TEST_CASE("integers do not mix with the observation") {
  OnnxFixture file;
  file.integers("one", {1});
  file.node("Add", {"obs", "one"}, "action");

  CHECK(refusal(file).find("computes with integers") != std::string::npos);
}

TEST_CASE("an action that does not depend on the observation is refused") {
  OnnxFixture file;
  file.node("Shape", {"obs"}, "size");
  set(file.node("Cast", {"size"}, "action"), "to", std::int64_t{1});

  CHECK(refusal(file).find("does not depend on the observation") != std::string::npos);
}

TEST_CASE("an output that contradicts its declared shape is refused") {
  OnnxFixture file;
  file.node("Tanh", {"obs"}, "action");
  auto& shape = *file.graph().mutable_output(0)->mutable_type()->mutable_tensor_type()->mutable_shape();
  shape.add_dim()->set_dim_param("N");
  shape.add_dim()->set_dim_value(3);
  CHECK(refusal(file) == "");

  shape.mutable_dim(1)->set_dim_value(2);
  CHECK(refusal(file).find("has the size 3 where the file declares 2") != std::string::npos);

  shape.add_dim()->set_dim_value(1);
  CHECK(refusal(file).find("has 2 dimensions, but the file declares 3") != std::string::npos);
}

TEST_CASE("values that grow without bound are refused before memory is spent") {
  OnnxFixture wide({0, 1});
  wide.floats("row", {1, 4096}, std::vector<float>(4096, 1.0f));
  wide.floats("column", {4096, 1}, std::vector<float>(4096, 1.0f));
  wide.node("Mul", {"row", "column"}, "table");
  wide.node("Mul", {"table", "obs"}, "action");
  CHECK(refusal(wide) != "");

  OnnxFixture copies({0, 1});
  copies.floats("row", {1, 100000}, std::vector<float>(100000, 1.0f));
  std::string last = "obs";
  for (int i = 0; i < 4; ++i) {
    copies.node("Mul", {last, "row"}, cat("v", i));
    last = cat("v", i);
  }
  copies.node("Identity", {last}, "action");
  CHECK(refusal(copies).find("between the nodes above 262144") != std::string::npos);

  OnnxFixture input({0, std::int64_t{1} << 40});
  input.node("Tanh", {"obs"}, "action");
  CHECK(refusal(input).find("makes a value of the size") != std::string::npos);
}

TEST_CASE("constants made again and again are refused before memory is spent") {
  OnnxFixture file;
  file.floats("row", {1, 2048}, std::vector<float>(2048, 1.0f));
  file.floats("column", {2048, 1}, std::vector<float>(2048, 1.0f));
  for (int i = 0; i < 100; ++i) file.node("Mul", {"row", "column"}, cat("table", i));
  std::string last = "table0";
  for (int i = 1; i < 100; ++i) {
    file.node("Add", {last, cat("table", i)}, cat("sum", i));
    last = cat("sum", i);
  }
  file.node("Add", {"obs", last}, "action");

  CHECK(refusal(file).find("beyond the limit for a policy") != std::string::npos);
}
