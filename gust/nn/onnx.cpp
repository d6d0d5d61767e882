#include "gust/nn/onnx.h"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "gust/core/error.h"
#include "gust/nn/onnx_graph.h"
#include "gust/nn/onnx_lowering.h"

namespace gust {
namespace {

std::optional<Activation> activation_of(const OnnxMap& map) {
  if (map.function == OnnxFunction::kTanh) return Activation::kTanh;
  if (map.function == OnnxFunction::kRelu) return Activation::kRelu;
  if (map.function == OnnxFunction::kLeakyRelu && map.a == 0.01f) return Activation::kLeakyRelu;
  return std::nullopt;
}

/// The shape of a program that is linear layers with the same activation between any two, each fed by the one before.
std::optional<MlpShape> chain_shape(const OnnxProgram& program) {
  MlpShape shape{.sizes = {program.widths[0]}};
  std::optional<Activation> activation;
  std::size_t last = 0;
  for (std::size_t i = 0; i < program.steps.size(); ++i) {
    const auto* dense = std::get_if<OnnxDense>(&program.steps[i]);
    const auto* map = std::get_if<OnnxMap>(&program.steps[i]);
    const bool expected = i % 2 == 0 ? dense != nullptr && dense->rows == 1 : map != nullptr;
    if (!expected || (dense != nullptr ? dense->from : map->from) != last) return std::nullopt;
    last = dense != nullptr ? dense->to : map->to;
    if (dense != nullptr) {
      shape.sizes.push_back(dense->outputs);
      continue;
    }
    const std::optional<Activation> kind = activation_of(*map);
    if (!kind || (activation && activation != kind)) return std::nullopt;
    activation = kind;
  }
  if (program.steps.size() % 2 == 0 || last != program.result) return std::nullopt;
  shape.activation = activation.value_or(Activation::kTanh);
  return shape;
}

std::optional<Mlp<float>> as_mlp(const OnnxProgram& program) {
  const std::optional<MlpShape> shape = chain_shape(program);
  if (!shape) return std::nullopt;
  Mlp<float> mlp(*shape);
  for (std::size_t layer = 0; layer < shape->layers(); ++layer) {
    const auto& dense = std::get<OnnxDense>(program.steps[2 * layer]);
    for (std::size_t output = 0; output < dense.outputs; ++output) {
      mlp.bias(layer, output) = dense.bias[output];
      for (std::size_t input = 0; input < dense.inputs; ++input) {
        mlp.weight(layer, output, input) = dense.weights[input * dense.outputs + output];
      }
    }
  }
  return mlp;
}

}  // namespace

OnnxModel read_onnx(std::string_view bytes, std::string_view name) {
  OnnxGraph graph = read_onnx_graph(bytes, name);
  OnnxMetadata metadata = std::move(graph.metadata);
  OnnxProgram program = OnnxLowering(std::move(graph)).program();
  std::optional<Mlp<float>> mlp = as_mlp(program);
  return {.program = std::move(program), .mlp = std::move(mlp), .metadata = std::move(metadata)};
}

OnnxRunner::OnnxRunner(const OnnxModel& model) : model_(model) {
  if (model.mlp) {
    workspace_.emplace(model.mlp->shape(), kLanes);
  } else {
    runner_.emplace(model.program);
  }
}

void OnnxRunner::run(std::span<const float> in, std::size_t lanes, std::span<float> out) {
  if (runner_) return runner_->run(in, lanes, out);
  GUST_CHECK(in.size() == lanes * model_.observations() && out.size() == lanes * model_.actions());
  for (std::size_t lane = 0; lane < lanes; lane += kLanes) {
    const std::size_t count = std::min(kLanes, lanes - lane);
    const auto block = in.subspan(lane * model_.observations(), count * model_.observations());
    const std::span<const float> result = workspace_->forward(*model_.mlp, block);
    std::copy(result.begin(), result.end(), out.begin() + static_cast<std::ptrdiff_t>(lane * model_.actions()));
  }
}

}  // namespace gust
