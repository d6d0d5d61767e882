#include "gust/onnx/onnx.h"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/graph.h"
#include "gust/onnx/lowering.h"

namespace gust {
namespace {

std::optional<Activation> activation_of(const OnnxMap& map) {
  if (map.function == OnnxFunction::kTanh) return Activation::kTanh;
  if (map.function == OnnxFunction::kRelu) return Activation::kRelu;
  if (map.function == OnnxFunction::kLeakyRelu && map.a == 0.01f) return Activation::kLeakyRelu;
  return std::nullopt;
}

/// The steps of a program that squash the result of a chain: tanh, perhaps a factor, perhaps a summand.
struct Ending {
  std::size_t steps = 0;
  std::size_t from = 0;  // the buffer that is squashed
  std::optional<ActionBox> box;
};

/// The constant of a step that combines the buffer `from` with one, if it is such a step.
const std::vector<float>* combined_row(const OnnxStep& step, OnnxArithmetic arithmetic, std::size_t from) {
  const auto* combine = std::get_if<OnnxCombine>(&step);
  if (combine == nullptr || combine->arithmetic != arithmetic) return nullptr;
  const bool row_right = combine->left.row.empty() && combine->left.buffer == from && !combine->right.row.empty();
  return row_right ? &combine->right.row : nullptr;
}

Ending find_ending(const OnnxProgram& program) {
  const std::size_t count = program.steps.size();
  for (std::size_t steps = 1; steps <= std::min<std::size_t>(count, 3); ++steps) {
    const auto* tanh = std::get_if<OnnxMap>(&program.steps[count - steps]);
    if (tanh == nullptr || tanh->function != OnnxFunction::kTanh) continue;
    const std::size_t width = program.widths[tanh->to];
    ActionBox box{std::vector<float>(width, 0.0f), std::vector<float>(width, 1.0f)};
    std::size_t at = tanh->to;
    std::size_t used = 1;
    const auto take = [&](OnnxArithmetic arithmetic, std::vector<float>& into) {
      if (used == steps) return;
      const OnnxStep& step = program.steps[count - steps + used];
      const std::vector<float>* row = combined_row(step, arithmetic, at);
      if (row == nullptr) return;
      into = *row;
      at = std::get<OnnxCombine>(step).to;
      ++used;
    };
    take(OnnxArithmetic::kMul, box.half_width);
    take(OnnxArithmetic::kAdd, box.centre);
    if (used == steps && at == program.result) return {steps, tanh->from, std::move(box)};
  }
  return {.from = program.result};
}

/// The shape of a program that, before its ending, is linear layers with the same activation between any two, each fed
/// by the one before.
std::optional<MlpShape> chain_shape(const OnnxProgram& program, const Ending& ending) {
  MlpShape shape{.sizes = {program.widths[0]}};
  std::optional<Activation> activation;
  std::size_t last = 0;
  const std::size_t count = program.steps.size() - ending.steps;
  for (std::size_t i = 0; i < count; ++i) {
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
  if (count % 2 == 0 || last != ending.from) return std::nullopt;
  shape.activation = activation.value_or(Activation::kTanh);
  return shape;
}

std::optional<ActorNetwork> as_actor(const OnnxProgram& program) {
  Ending ending = find_ending(program);
  const std::optional<MlpShape> shape = chain_shape(program, ending);
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
  return ActorNetwork{.mlp = std::move(mlp), .box = std::move(ending.box)};
}

std::optional<float> level_of(const OnnxGraph& graph) {
  if (!graph.conditional) return std::nullopt;
  return graph.constants.at("alpha").floats.front();
}

void set_level(OnnxGraph& graph, float alpha) {
  if (!graph.conditional) throw Error(cat(graph.file, ": the policy has no input 'alpha'; it acts at one risk level"));
  graph.constants.at("alpha").floats.front() = alpha;
}

}  // namespace

OnnxModel read_onnx(std::string_view bytes, std::string_view name, const OnnxReading& reading) {
  const OnnxData none;
  OnnxGraph graph = read_onnx_graph(bytes, name, reading.output, reading.data != nullptr ? *reading.data : none);
  if (reading.alpha) set_level(graph, *reading.alpha);
  const std::optional<float> level = level_of(graph);
  OnnxMetadata metadata = std::move(graph.metadata);
  OnnxProgram program = OnnxLowering(std::move(graph)).program();
  std::optional<ActorNetwork> actor = as_actor(program);
  return {.program = std::move(program), .actor = std::move(actor), .alpha = level, .metadata = std::move(metadata)};
}

OnnxRunner::OnnxRunner(const OnnxModel& model) : model_(model) {
  if (model.actor) {
    actor_.emplace(*model.actor, kLanes);
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
    const std::span<const float> result = actor_->act(block);
    std::copy(result.begin(), result.end(), out.begin() + static_cast<std::ptrdiff_t>(lane * model_.actions()));
  }
}

}  // namespace gust
