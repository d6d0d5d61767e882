#include "gust/onnx/graph.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

/// action = tanh(obs), in two nodes.
OnnxFixture two_nodes() {
  OnnxFixture file;
  file.node("Tanh", {"obs"}, "hidden");
  file.node("Identity", {"hidden"}, "action");
  return file;
}

}  // namespace

TEST_CASE("a graph gives what the action needs, in an order that can be computed") {
  OnnxFixture file;
  file.node("Add", {"hidden", "one"}, "action");
  file.node("Tanh", {"obs"}, "hidden");
  file.node("Erf", {"hidden"}, "unused");
  file.floats("one", {}, {1.0f});
  file.floats("unused weights", {}, {2.0f});

  const OnnxGraph graph = read_onnx_graph(file.bytes(), "test.onnx");

  REQUIRE(graph.nodes.size() == 2);
  CHECK(graph.nodes[0].op == "Tanh");
  CHECK(graph.nodes[1].op == "Add");
  CHECK(graph.constants.size() == 1);
  CHECK(graph.input == "obs");
  CHECK(graph.input_dims == OnnxDims{kOnnxBatch, 3});
  CHECK(graph.fixed_batch == 0);
}

TEST_CASE("the output named action, or actions, or the only one is taken") {
  OnnxFixture file = two_nodes();
  file.graph().mutable_output(0)->set_name("hidden");
  CHECK(read_onnx_graph(file.bytes(), "test.onnx").output == "hidden");

  file.graph().add_output()->set_name("action");
  CHECK(read_onnx_graph(file.bytes(), "test.onnx").output == "action");

  file.graph().add_output()->set_name("actions");
  file.node("Tanh", {"hidden"}, "actions");
  CHECK(refusal(file).find("more than one output that may be the action: 'action' of unknown shape, 'actions'") !=
        std::string::npos);

  file.graph().clear_output();
  CHECK(refusal(file).find("the graph has no output") != std::string::npos);
}

TEST_CASE("an initializer that is listed as an input too is a constant") {
  OnnxFixture file;
  file.input("bias", {3});
  file.floats("bias", {3}, {1.0f, 2.0f, 3.0f});
  file.node("Add", {"obs", "bias"}, "action");

  CHECK(act(file, {1.0f, 1.0f, 1.0f}) == std::vector{2.0f, 3.0f, 4.0f});
}

TEST_CASE("a graph with a cycle is refused, and the cycle is named") {
  OnnxFixture file;
  file.node("Add", {"obs", "b"}, "a");
  file.node("Tanh", {"a"}, "b");
  file.node("Identity", {"b"}, "action");

  const std::string message = refusal(file);

  CHECK(
      message ==
      "test.onnx: the graph has a cycle through node 'the Tanh' of type 'Tanh', node 'the Add' of type 'Add'; a policy "
      "must be feed-forward");
}

TEST_CASE("a chain of a hundred thousand nodes that ends in a cycle is refused without a deep stack") {
  OnnxFixture file;
  std::string last = "action";
  for (int i = 0; i < 90'000; ++i) {
    auto& node = *file.graph().add_node();
    node.set_op_type("Tanh");
    node.add_output(last);
    last = cat("v", i);
    node.add_input(last);
  }
  file.node("Tanh", {"v0"}, last);

  CHECK(refusal(file).find("cycle") != std::string::npos);
}

TEST_CASE("a name that nothing defines, or two things define, is refused") {
  OnnxFixture missing;
  missing.node("Add", {"obs", "bias"}, "action");
  CHECK(refusal(missing).find("needs 'bias', which no node, initializer or input defines") != std::string::npos);

  OnnxFixture no_action;
  CHECK(refusal(no_action).find("needs 'action'") != std::string::npos);

  OnnxFixture twice = two_nodes();
  twice.node("Relu", {"obs"}, "hidden");
  CHECK(refusal(twice).find("'hidden' is defined twice") != std::string::npos);

  OnnxFixture weights = two_nodes();
  weights.floats("w", {}, {1.0f});
  weights.floats("w", {}, {2.0f});
  CHECK(refusal(weights).find("'w' is defined twice") != std::string::npos);

  OnnxFixture shadow = two_nodes();
  shadow.floats("hidden", {}, {1.0f});
  CHECK(refusal(shadow).find("'hidden' is defined twice") != std::string::npos);

  OnnxFixture input = two_nodes();
  input.input("obs", {0, 3});
  CHECK(refusal(input).find("'obs' is defined twice") != std::string::npos);
}

TEST_CASE("a policy has one input, of a known size and of floats") {
  OnnxFixture two;
  two.input("goal", {0, 3});
  two.node("Sub", {"obs", "goal"}, "action");
  CHECK(refusal(two).find("needs the inputs 'goal', 'obs'; a policy has one input") != std::string::npos);

  OnnxFixture unused = two_nodes();
  unused.input("goal", {0, 3});
  CHECK(refusal(unused) == "");

  OnnxFixture none;
  none.floats("one", {1, 1}, {1.0f});
  none.node("Identity", {"one"}, "action");
  CHECK(refusal(none).find("does not depend on any input") != std::string::npos);

  OnnxFixture open({0, 0});
  open.node("Identity", {"obs"}, "action");
  CHECK(refusal(open).find("has no fixed number of observations") != std::string::npos);

  OnnxFixture integers = two_nodes();
  integers.graph().mutable_input(0)->mutable_type()->mutable_tensor_type()->set_elem_type(onnx::TensorProto::INT64);
  CHECK(refusal(integers).find("is of type int64") != std::string::npos);
}

TEST_CASE("a fixed batch is kept apart from the observation") {
  OnnxFixture file({5, 3});
  file.node("Identity", {"obs"}, "action");

  const OnnxGraph graph = read_onnx_graph(file.bytes(), "test.onnx");

  CHECK(graph.fixed_batch == 5);
  CHECK(graph.input_dims == OnnxDims{kOnnxBatch, 3});
}

TEST_CASE("opset 7 is the oldest, 30 the newest, and a file without one is no model") {
  OnnxFixture file = two_nodes();
  file.model.mutable_opset_import(0)->set_version(7);
  CHECK(refusal(file) == "");

  file.model.mutable_opset_import(0)->set_version(6);
  CHECK(refusal(file).find("is of opset 6; opset 7 or later is needed") != std::string::npos);

  file.model.mutable_opset_import(0)->set_version(9999);
  CHECK(refusal(file).find("is of opset 9999; the newest that is known is 30") != std::string::npos);

  file.model.mutable_opset_import(0)->set_domain("ai.onnx.ml");
  CHECK(refusal(file).find("names no opset") != std::string::npos);

  OnnxFixture hollow = two_nodes();
  hollow.model.clear_graph();
  CHECK(refusal(hollow).find("holds no graph") != std::string::npos);
}

TEST_CASE("names in messages are printable and short") {
  CHECK(onnx_quoted("fc1") == "'fc1'");
  CHECK(onnx_quoted("a\nb\x1b[31m\xff") == "'a?b?[31m?'");
  CHECK(onnx_quoted(std::string(1000, 'x')).size() == 85);
}

TEST_CASE("weights beyond the limit are refused") {
  OnnxFixture file;
  const std::size_t half = kOnnxElements / 2 + 1;
  for (const std::string name : {"a", "b"}) {
    onnx::TensorProto& tensor = *file.graph().add_initializer();
    tensor.set_name(name);
    tensor.set_data_type(onnx::TensorProto::BOOL);
    tensor.add_dims(static_cast<std::int64_t>(half));
    tensor.set_raw_data(std::string(half, '\0'));
  }
  file.node("Concat", {"obs", "a", "b"}, "action");

  CHECK(refusal(file).find("holds more than 16777216 weights") != std::string::npos);
}
