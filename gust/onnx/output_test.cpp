#include "gust/onnx/output.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

/// Outputs of these names, each computed from the observation, in that order.
OnnxFixture outputs(const std::vector<std::string>& names) {
  OnnxFixture file;
  file.graph().clear_output();
  for (const std::string& name : names) {
    file.graph().add_output()->set_name(name);
    file.node("Tanh", {"obs"}, name);
  }
  return file;
}

std::string chosen(const OnnxFixture& file) { return choose_onnx_output(file.model.graph(), "", "test.onnx").name(); }

}  // namespace

TEST_CASE("the action is found by the names that it has among exporters") {
  CHECK(chosen(outputs({"value", "Actions"})) == "Actions");
  CHECK(chosen(outputs({"V", "ACTION"})) == "ACTION");
  CHECK(chosen(outputs({"value", "log_std", "mu"})) == "mu");
  CHECK(chosen(outputs({"log_std", "Mean"})) == "Mean");
  CHECK(chosen(outputs({"continuous_actions", "deterministic_continuous_actions"})) ==
        "deterministic_continuous_actions");
  CHECK(chosen(outputs({"mean", "action"})) == "action");
  CHECK(chosen(outputs({"linear_2"})) == "linear_2");
}

TEST_CASE("outputs that are constant or hand an input on are not the action") {
  OnnxFixture file = outputs({"output"});
  file.floats("three", {1}, {3.0f});
  file.input("state_ins", {1});
  file.graph().mutable_output()->Clear();
  for (const char* name : {"version_number", "state_outs", "sizes", "output"})
    file.graph().add_output()->set_name(name);
  file.node("Identity", {"three"}, "version_number");
  file.node("Identity", {"state_ins"}, "state_outs");
  file.node("Shape", {"obs"}, "sizes");

  CHECK(chosen(file) == "output");
  CHECK(refusal(file) == "");
}

TEST_CASE("several outputs that may be the action are listed with their shapes") {
  OnnxFixture file = outputs({"value", "logits"});
  file.graph().mutable_output(1)->mutable_type()->mutable_tensor_type()->mutable_shape()->add_dim()->set_dim_param("N");
  file.graph().mutable_output(1)->mutable_type()->mutable_tensor_type()->mutable_shape()->add_dim()->set_dim_value(3);

  CHECK(refusal(file) ==
        "test.onnx: has more than one output that may be the action: 'value' of unknown shape, 'logits' [N, 3]; say "
        "which: output = \"NAME\" in a study, --output NAME for gust eval");
  CHECK(read_onnx(file.bytes(), "test.onnx", {.output = "logits"}).actions() == 3);
  CHECK_THROWS_WITH_AS(read_onnx(file.bytes(), "test.onnx", {.output = "logit"}),
                       "test.onnx: has no output 'logit'; did you mean 'logits'?; it has 'value' of unknown shape, "
                       "'logits' [N, 3]",
                       Error);
}

TEST_CASE("an action of random samples is refused with the way out, a recurrent network by the name of its node") {
  OnnxFixture noisy;
  noisy.node("RandomNormalLike", {"obs"}, "noise");
  noisy.node("Add", {"obs", "noise"}, "action");
  CHECK(refusal(noisy).find("samples at random; choose the output of the action without noise") != std::string::npos);

  for (const char* op : {"LSTM", "GRU", "RNN", "Scan", "Loop"}) {
    OnnxFixture recurrent;
    recurrent.input("h0", {1, 1, 8});
    recurrent.node(op, {"obs", "h0"}, "action");
    const std::string message = refusal(recurrent);
    CHECK(message.find(cat("node 'the ", op, "' of type '", op, "': is recurrent")) != std::string::npos);
  }

  OnnxFixture state;
  state.input("h0", {0, 3});
  state.node("Add", {"obs", "h0"}, "action");
  CHECK(refusal(state).find("needs the inputs 'h0', 'obs'") != std::string::npos);
  CHECK(refusal(state).find("A recurrent network, whose state is an input, cannot be used") != std::string::npos);
}
