#include "gust/nn/onnx_program.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gust/core/error.h"
#include "gust/core/math.h"

namespace gust {
namespace {

Product<float> product_of(const OnnxDense& dense, std::size_t rows) {
  const auto outputs = static_cast<int>(dense.outputs);
  const auto inputs = static_cast<int>(dense.inputs);
  return Product<float>({.m = outputs, .n = static_cast<int>(rows), .k = inputs});
}

void add_bias(const OnnxDense& dense, std::span<float> rows) {
  for (float* row = rows.data(); row != rows.data() + rows.size(); row += dense.outputs) {
    for (std::size_t j = 0; j < dense.outputs; ++j) row[j] += dense.bias[j];
  }
}

template <class F>
void map_all(std::span<const float> from, float* to, F f) {
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = f(from[i]);
}

template <class F>
void combine_all(const float* left, const float* right, std::span<float> to, F f) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = f(left[i], right[i]);
}

template <class F>
void for_each_source(const OnnxStep& step, F visit) {
  if (const auto* combine = std::get_if<OnnxCombine>(&step)) {
    if (combine->left.row.empty()) visit(combine->left.buffer);
    if (combine->right.row.empty()) visit(combine->right.buffer);
  } else if (const auto* pick = std::get_if<OnnxPick>(&step)) {
    for (const OnnxPick::Source& source : pick->sources) visit(source.buffer);
  } else if (const auto* map = std::get_if<OnnxMap>(&step)) {
    visit(map->from);
  } else {
    visit(std::get<OnnxDense>(step).from);
  }
}

// Floats reach far beyond the range in which exp() is neither zero nor infinite; the bounds keep its integers from
// overflowing.
double exponential(double x) {
  const double above = x < -709.0 ? -709.0 : x;
  return exp(above > 710.0 ? 710.0 : above);
}

double hyperbolic_tangent(double x) {
  const double size = x < 0.0 ? -x : x;
  const double y = 1.0 - 2.0 / (exponential(2.0 * size) + 1.0);
  return x < 0.0 ? -y : y;
}

double softplus(double x) {
  const double tail = exponential(x < 0.0 ? x : -x);
  return (x < 0.0 ? 0.0 : x) + log(1.0 + tail);  // NaN stays NaN
}

}  // namespace

void apply(const OnnxDense& dense, std::span<const float> from, float* to) {
  const auto rows = from.size() / dense.inputs;
  product_of(dense, rows).plain(dense.weights.data(), from.data(), to);
  add_bias(dense, {to, rows * dense.outputs});
}

void apply(const OnnxMap& map, std::span<const float> from, float* to) {
  const float a = map.a;
  const float b = map.b;
  const auto elu = [a](float x) { return x < 0.0f ? static_cast<float>(a * (exponential(double{x}) - 1.0)) : x; };
  const auto sigmoid = [](float x) { return static_cast<float>(1.0 / (1.0 + exponential(-double{x}))); };
  const auto clip = [a, b](float x) {
    const float above = x < a ? a : x;
    return above > b ? b : above;
  };
  switch (map.function) {
    case OnnxFunction::kTanh:
      return map_all(from, to, [](float x) { return static_cast<float>(hyperbolic_tangent(double{x})); });
    case OnnxFunction::kRelu:
      return map_all(from, to, [](float x) { return x < 0.0f ? 0.0f : x; });
    case OnnxFunction::kLeakyRelu:
      return map_all(from, to, [a](float x) { return x < 0.0f ? a * x : x; });
    case OnnxFunction::kElu:
      return map_all(from, to, elu);
    case OnnxFunction::kSigmoid:
      return map_all(from, to, sigmoid);
    case OnnxFunction::kSoftplus:
      return map_all(from, to, [](float x) { return static_cast<float>(softplus(x)); });
    case OnnxFunction::kExp:
      return map_all(from, to, [](float x) { return static_cast<float>(exponential(double{x})); });
    case OnnxFunction::kSqrt:
      return map_all(from, to, [](float x) { return std::sqrt(x); });
    case OnnxFunction::kClip:
      return map_all(from, to, clip);
  }
}

void apply(OnnxArithmetic arithmetic, const float* left, const float* right, std::span<float> to) {
  switch (arithmetic) {
    case OnnxArithmetic::kAdd:
      return combine_all(left, right, to, [](float x, float y) { return x + y; });
    case OnnxArithmetic::kSub:
      return combine_all(left, right, to, [](float x, float y) { return x - y; });
    case OnnxArithmetic::kMul:
      return combine_all(left, right, to, [](float x, float y) { return x * y; });
    case OnnxArithmetic::kDiv:
      return combine_all(left, right, to, [](float x, float y) { return x / y; });
    case OnnxArithmetic::kMin:
      return combine_all(left, right, to, [](float x, float y) { return x <= y || x != x ? x : y; });
    case OnnxArithmetic::kMax:
      return combine_all(left, right, to, [](float x, float y) { return x >= y || x != x ? x : y; });
  }
}

std::size_t OnnxProgram::add_buffer(std::size_t width) {
  widths.push_back(width);
  return widths.size() - 1;
}

void OnnxProgram::remove_unused() {
  std::vector<bool> used(widths.size(), false);
  used[result] = true;
  std::vector<OnnxStep> kept;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const bool needed = std::visit([&](const auto& kind) { return bool{used[kind.to]}; }, *step);
    if (!needed) continue;
    for_each_source(*step, [&](std::size_t buffer) { used[buffer] = true; });
    kept.push_back(std::move(*step));
  }
  std::reverse(kept.begin(), kept.end());
  steps = std::move(kept);
  for (std::size_t buffer = 1; buffer < widths.size(); ++buffer) {
    if (!used[buffer]) widths[buffer] = 0;
  }
}

OnnxProgramRunner::OnnxProgramRunner(OnnxProgram program) : program_(std::move(program)) {
  std::size_t total = 0;
  for (const std::size_t width : program_.widths) {
    offsets_.push_back(total);
    total += (width * kBlock + 15) / 16 * 16;
  }
  scratch_.assign(total, 0.0f);
  for (OnnxStep& step : program_.steps) {
    auto* dense = std::get_if<OnnxDense>(&step);
    if (dense != nullptr) dense->product = product_of(*dense, dense->rows * kBlock);
  }
}

void OnnxProgramRunner::run(std::span<const float> in, std::size_t lanes, std::span<float> out) {
  const std::size_t in_width = program_.widths[0];
  const std::size_t out_width = program_.widths[program_.result];
  GUST_CHECK(in.size() == lanes * in_width && out.size() == lanes * out_width);
  for (std::size_t lane = 0; lane < lanes; lane += kBlock) {
    const std::size_t count = std::min(kBlock, lanes - lane);
    float* first = buffer(0);
    std::copy_n(in.data() + lane * in_width, count * in_width, first);
    std::fill(first + count * in_width, first + kBlock * in_width, 0.0f);
    for (const OnnxStep& next : program_.steps) {
      std::visit([&](const auto& kind) { step(kind); }, next);
    }
    std::copy_n(buffer(program_.result), count * out_width, out.data() + lane * out_width);
  }
}

void OnnxProgramRunner::step(const OnnxDense& dense) {
  float* to = buffer(dense.to);
  dense.product(dense.weights.data(), buffer(dense.from), to);
  add_bias(dense, {to, dense.rows * kBlock * dense.outputs});
}

void OnnxProgramRunner::step(const OnnxMap& map) {
  const std::size_t size = program_.widths[map.from] * kBlock;
  apply(map, {buffer(map.from), size}, buffer(map.to));
}

void OnnxProgramRunner::step(const OnnxCombine& combine) {
  const std::size_t width = program_.widths[combine.to];
  for (std::size_t lane = 0; lane < kBlock; ++lane) {
    const auto row = [&](const OnnxOperand& operand) {
      return operand.row.empty() ? buffer(operand.buffer) + lane * width : operand.row.data();
    };
    apply(combine.arithmetic, row(combine.left), row(combine.right), {buffer(combine.to) + lane * width, width});
  }
}

void OnnxProgramRunner::step(const OnnxPick& pick) {
  const std::size_t width = pick.sources.size();
  float* to = buffer(pick.to);
  for (std::size_t j = 0; j < width; ++j) {
    const auto [source, element] = pick.sources[j];
    const float* from = buffer(source) + element;
    const std::size_t stride = program_.widths[source];
    for (std::size_t lane = 0; lane < kBlock; ++lane) to[lane * width + j] = from[lane * stride];
  }
}

}  // namespace gust
