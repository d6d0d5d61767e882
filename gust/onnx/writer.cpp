#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/onnx.h"
#include "gust/onnx/proto.h"

namespace gust {
namespace {

constexpr std::int64_t kOpset = 17;
constexpr std::int64_t kIrVersion = 8;  // the one that came with opset 17

enum class Batched { kNo, kYes };

void describe_value(onnx::ValueInfoProto& info, const std::string& name, std::size_t width, Batched batched) {
  info.set_name(name);
  auto& tensor = *info.mutable_type()->mutable_tensor_type();
  tensor.set_elem_type(onnx::TensorProto::FLOAT);
  if (batched == Batched::kYes) tensor.mutable_shape()->add_dim()->set_dim_param("N");
  tensor.mutable_shape()->add_dim()->set_dim_value(static_cast<std::int64_t>(width));
}

void add_tensor(onnx::GraphProto& graph, const std::string& name, const OnnxTensor& tensor) {
  onnx::TensorProto& proto = *graph.add_initializer();
  proto.set_name(name);
  proto.set_data_type(onnx::TensorProto::FLOAT);
  for (const std::int64_t dim : tensor.dims) proto.add_dims(dim);
  proto.set_raw_data(tensor.floats.data(), tensor.floats.size() * sizeof(float));
}

onnx::NodeProto& add_node(onnx::GraphProto& graph, const std::string& op, const std::string& from,
                          const std::string& to) {
  onnx::NodeProto& node = *graph.add_node();
  node.set_name(to);
  node.set_op_type(op);
  node.add_input(from);
  node.add_output(to);
  return node;
}

void add_row(onnx::GraphProto& graph, const std::string& name, const std::vector<float>& row) {
  add_tensor(graph, name, {.dims = {static_cast<std::int64_t>(row.size())}, .floats = row, .integers = {}});
}

/// The first biases of an actor that takes a risk level: bias + alpha weight, the level's default in the file.
void add_level(onnx::GraphProto& graph, const ActorNetwork& actor) {
  describe_value(*graph.add_input(), "alpha", 1, Batched::kNo);
  add_row(graph, "alpha", {*actor.alpha});
  std::vector<float> weights;
  for (std::size_t output = 0; output < actor.mlp.shape().sizes[1]; ++output)
    weights.push_back(actor.mlp.weight(0, output, actor.observations()));
  add_row(graph, "weight_alpha", weights);
  add_node(graph, "Mul", "alpha", "bias_of_alpha").add_input("weight_alpha");
  add_node(graph, "Add", "bias0", "bias_at_alpha").add_input("bias_of_alpha");
}

/// tanh, and its stretching over the box where that is not -1 … 1.
void add_box(onnx::GraphProto& graph, const ActionBox& box) {
  const bool wide = std::ranges::any_of(box.half_width, [](float half) { return half != 1.0f; });
  const bool moved = std::ranges::any_of(box.centre, [](float centre) { return centre != 0.0f; });
  add_node(graph, "Tanh", "mean", wide || moved ? "squashed" : "action");
  if (wide) {
    add_row(graph, "half_width", box.half_width);
    add_node(graph, "Mul", "squashed", moved ? "stretched" : "action").add_input("half_width");
  }
  if (moved) {
    add_row(graph, "centre", box.centre);
    add_node(graph, "Add", wide ? "stretched" : "squashed", "action").add_input("centre");
  }
}

/// Weights as PyTorch keeps them, output by output.
void add_layer(onnx::GraphProto& graph, const ActorNetwork& actor, std::size_t layer) {
  const Mlp<float>& mlp = actor.mlp;
  const auto inputs = static_cast<std::int64_t>(layer == 0 ? actor.observations() : mlp.shape().sizes[layer]);
  const auto outputs = static_cast<std::int64_t>(mlp.shape().sizes[layer + 1]);
  OnnxTensor weights{.dims = {outputs, inputs}, .floats = {}, .integers = {}};
  OnnxTensor bias{.dims = {outputs}, .floats = {}, .integers = {}};
  for (std::size_t output = 0; output < mlp.shape().sizes[layer + 1]; ++output) {
    bias.floats.push_back(mlp.bias(layer, output));
    for (std::size_t input = 0; input < static_cast<std::size_t>(inputs); ++input) {
      weights.floats.push_back(mlp.weight(layer, output, input));
    }
  }
  const bool last = layer + 1 == mlp.shape().layers();
  const std::string from = layer == 0 ? "obs" : cat("hidden", layer - 1);
  const std::string result = actor.box ? "mean" : "action";
  onnx::NodeProto& node = add_node(graph, "Gemm", from, last ? result : cat("sum", layer));
  node.add_input(cat("weight", layer));
  node.add_input(layer == 0 && actor.alpha ? "bias_at_alpha" : cat("bias", layer));
  onnx::AttributeProto& transposed = *node.add_attribute();
  transposed.set_name("transB");
  transposed.set_type(onnx::AttributeProto::INT);
  transposed.set_i(1);
  add_tensor(graph, cat("weight", layer), weights);
  add_tensor(graph, cat("bias", layer), bias);
}

void add_activation(onnx::GraphProto& graph, Activation activation, std::size_t layer) {
  const std::string from = cat("sum", layer);
  const std::string to = cat("hidden", layer);
  switch (activation) {
    case Activation::kTanh:
      add_node(graph, "Tanh", from, to);
      return;
    case Activation::kRelu:
      add_node(graph, "Relu", from, to);
      return;
    case Activation::kIdentity:
      add_node(graph, "Identity", from, to);
      return;
    case Activation::kLeakyRelu: {
      onnx::AttributeProto& slope = *add_node(graph, "LeakyRelu", from, to).add_attribute();
      slope.set_name("alpha");
      slope.set_type(onnx::AttributeProto::FLOAT);
      slope.set_f(0.01f);
      return;
    }
  }
}

}  // namespace

std::string write_onnx(const ActorNetwork& actor, const OnnxMetadata& metadata) {
  const OnnxMessage model;
  model->set_ir_version(kIrVersion);
  model->set_producer_name("gust");
  for (const auto& [key, value] : metadata) {
    onnx::StringStringEntryProto& entry = *model->add_metadata_props();
    entry.set_key(key);
    entry.set_value(value);
  }
  onnx::GraphProto& graph = *model->mutable_graph();
  graph.set_name("policy");
  const MlpShape& shape = actor.mlp.shape();
  describe_value(*graph.add_input(), "obs", actor.observations(), Batched::kYes);
  describe_value(*graph.add_output(), "action", actor.actions(), Batched::kYes);
  if (actor.alpha) add_level(graph, actor);
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    add_layer(graph, actor, layer);
    if (layer + 1 < shape.layers()) add_activation(graph, shape.after(layer), layer);
  }
  if (actor.box) add_box(graph, *actor.box);
  // The opset, which no reader does without, comes last: a file that lost its end is refused.
  const OnnxMessage end;
  onnx::OperatorSetIdProto& opset = *end->add_opset_import();
  opset.set_domain("");
  opset.set_version(kOpset);
  return model->SerializeAsString() + end->SerializeAsString();
}

}  // namespace gust
