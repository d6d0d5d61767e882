#pragma once

#include <onnx/onnx.pb.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/onnx.h"

namespace gust {

/// An ONNX file in the making, for tests: input obs [N, 3] unless said otherwise, output action, opset 17.
struct OnnxFixture {
  onnx::ModelProto model;

  explicit OnnxFixture(std::initializer_list<std::int64_t> obs_dims = {0, 3}) {
    model.set_ir_version(8);
    model.add_opset_import()->set_version(17);
    model.mutable_graph()->add_output()->set_name("action");
    input("obs", obs_dims);
  }

  onnx::GraphProto& graph() { return *model.mutable_graph(); }

  /// An input of float32; a size of 0 is left open.
  onnx::ValueInfoProto& input(const std::string& name, std::initializer_list<std::int64_t> dims) {
    onnx::ValueInfoProto& info = *graph().add_input();
    info.set_name(name);
    info.mutable_type()->mutable_tensor_type()->set_elem_type(onnx::TensorProto::FLOAT);
    for (const std::int64_t dim : dims) {
      auto& entry = *info.mutable_type()->mutable_tensor_type()->mutable_shape()->add_dim();
      dim == 0 ? entry.set_dim_param("N") : entry.set_dim_value(dim);
    }
    return info;
  }

  onnx::TensorProto& floats(const std::string& name, const std::vector<std::int64_t>& dims,
                            const std::vector<float>& values) {
    onnx::TensorProto& tensor = *graph().add_initializer();
    tensor.set_name(name);
    tensor.set_data_type(onnx::TensorProto::FLOAT);
    for (const std::int64_t dim : dims) tensor.add_dims(dim);
    for (const float value : values) tensor.add_float_data(value);
    return tensor;
  }

  onnx::TensorProto& integers(const std::string& name, const std::vector<std::int64_t>& values) {
    onnx::TensorProto& tensor = *graph().add_initializer();
    tensor.set_name(name);
    tensor.set_data_type(onnx::TensorProto::INT64);
    tensor.add_dims(static_cast<std::int64_t>(values.size()));
    for (const std::int64_t value : values) tensor.add_int64_data(value);
    return tensor;
  }

  onnx::NodeProto& node(const std::string& op, const std::vector<std::string>& inputs, const std::string& output) {
    onnx::NodeProto& node = *graph().add_node();
    node.set_op_type(op);
    node.set_name(cat("the ", op));
    for (const std::string& input : inputs) node.add_input(input);
    node.add_output(output);
    return node;
  }

  std::string bytes() const { return model.SerializeAsString(); }
};

inline void set(onnx::NodeProto& node, const std::string& name, std::int64_t value) {
  onnx::AttributeProto& attribute = *node.add_attribute();
  attribute.set_name(name);
  attribute.set_type(onnx::AttributeProto::INT);
  attribute.set_i(value);
}

inline void set(onnx::NodeProto& node, const std::string& name, float value) {
  onnx::AttributeProto& attribute = *node.add_attribute();
  attribute.set_name(name);
  attribute.set_type(onnx::AttributeProto::FLOAT);
  attribute.set_f(value);
}

inline void set_list(onnx::NodeProto& node, const std::string& name, std::initializer_list<std::int64_t> values) {
  onnx::AttributeProto& attribute = *node.add_attribute();
  attribute.set_name(name);
  attribute.set_type(onnx::AttributeProto::INTS);
  for (const std::int64_t value : values) attribute.add_ints(value);
}

/// The actions for observations, lane by lane.
inline std::vector<float> act(const std::string& bytes, const std::vector<float>& observations) {
  const OnnxModel model = read_onnx(bytes, "test.onnx");
  const std::size_t lanes = observations.size() / model.observations();
  std::vector<float> actions(lanes * model.actions());
  OnnxRunner(model).run(observations, lanes, actions);
  return actions;
}

inline std::vector<float> act(const OnnxFixture& file, const std::vector<float>& observations) {
  return act(file.bytes(), observations);
}

/// Why the bytes are refused; empty if they are not.
inline std::string refusal(const std::string& bytes) {
  try {
    read_onnx(bytes, "test.onnx");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline std::string refusal(const OnnxFixture& file) { return refusal(file.bytes()); }

}  // namespace gust
