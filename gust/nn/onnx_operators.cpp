#include "gust/nn/onnx_operators.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "gust/core/error.h"
#include "gust/core/text.h"

namespace gust {
namespace {

/// A constant matrix that stands on the right of a product, inputs first.
struct Weights {
  std::size_t inputs = 0;
  std::size_t outputs = 0;
  Buffer<float> values = {};
};

/// The constant floats of a value. `what` names it.
const std::vector<float>& constant_floats(const OnnxLowering& at, const OnnxValue& value, std::string_view what) {
  if (value.constant == nullptr) at.fail(cat("takes ", what, " that depend on the observation; they must be constant"));
  if (value.constant->integral) at.fail(cat("takes integers as ", what, "; they must be float32 or float64"));
  return value.constant->floats;
}

Weights read_weights(const OnnxLowering& at, const OnnxValue& value, bool transposed, float factor) {
  const std::vector<float>& values = constant_floats(at, value, "weights");
  if (value.dims.size() != 2) {
    at.fail(cat("multiplies with ", value.dims.size(), " dimensions; the weights must be a matrix"));
  }
  const auto rows = static_cast<std::size_t>(value.dims[0]);
  const auto columns = static_cast<std::size_t>(value.dims[1]);
  Weights weights{.inputs = transposed ? columns : rows, .outputs = transposed ? rows : columns};
  weights.values.resize(values.size());
  for (std::size_t i = 0; i < weights.inputs; ++i) {
    for (std::size_t j = 0; j < weights.outputs; ++j) {
      const std::size_t from = transposed ? j * columns + i : i * columns + j;
      weights.values[i * weights.outputs + j] = factor * values[from];
    }
  }
  return weights;
}

void check_product(const OnnxLowering& at, const OnnxValue& from, std::size_t inputs) {
  if (from.dims.empty() || from.dims.back() == kOnnxBatch) {
    at.fail("multiplies across the batch; every lane must stay by itself");
  }
  if (from.dims.back() != static_cast<std::int64_t>(inputs)) {
    at.fail(cat("multiplies ", from.dims.back(), " numbers with weights for ", inputs));
  }
}

/// The transpose of a constant matrix.
OnnxValue transposed_matrix(OnnxLowering& at, const OnnxValue& value) {
  Weights columns = read_weights(at, value, /*transposed=*/true, 1.0f);
  const OnnxDims dims = {value.dims[1], value.dims[0]};
  return at.constant({.dims = dims, .floats = {columns.values.begin(), columns.values.end()}, .integers = {}});
}

OnnxValue scaled(OnnxLowering& at, const OnnxValue& value, float factor) {
  if (factor == 1.0f) return value;
  const OnnxValue constant = at.constant({.dims = {}, .floats = {factor}, .integers = {}});
  return at.combine(OnnxArithmetic::kMul, value, constant);
}

/// alpha A' B' + beta C; the factors go into the weights and the bias.
void lower_gemm(OnnxLowering& at) {
  OnnxValue from = at.input(0);
  if (at.attribute("transA", std::int64_t{0}) != 0) from = transposed_matrix(at, from);
  if (from.dims.size() != 2) at.fail(cat("takes a matrix, but its first input has ", from.dims.size(), " dimensions"));
  const bool transposed = at.attribute("transB", std::int64_t{0}) != 0;
  Weights weights = read_weights(at, at.input(1), transposed, at.attribute("alpha", 1.0f));
  check_product(at, from, weights.inputs);
  std::vector<float> bias(weights.outputs, 0.0f);
  const float beta = at.attribute("beta", 1.0f);
  std::optional<OnnxValue> summand;
  if (at.has_input(2) && beta != 0.0f) summand = scaled(at, at.input(2), beta);
  const OnnxDims row = {1, static_cast<std::int64_t>(weights.outputs)};
  const bool is_bias = summand && summand->constant != nullptr && at.broadcast_dims(row, summand->dims) == row;
  if (is_bias) bias = constant_floats(at, at.broadcast(*summand, row), "summands");
  const OnnxValue product = at.dense(from, std::move(weights.values), std::move(bias));
  const OnnxValue result = summand && !is_bias ? at.combine(OnnxArithmetic::kAdd, product, *summand) : product;
  if (result.dims != product.dims) at.fail("has a third input that does not fit the product of the first two");
  at.set_output(0, result);
}

void lower_matmul(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  OnnxValue right = at.input(1);
  const bool vector = right.dims.size() == 1;
  if (vector) right = at.reshaped(right, {right.dims[0], 1});
  Weights weights = read_weights(at, right, false, 1.0f);
  check_product(at, from, weights.inputs);
  std::vector<float> bias(weights.outputs, 0.0f);
  OnnxValue product = at.dense(from, std::move(weights.values), std::move(bias));
  if (vector) product.dims.pop_back();
  at.set_output(0, std::move(product));
}

template <OnnxArithmetic arithmetic>
void lower_combine(OnnxLowering& at) {
  at.set_output(0, at.combine(arithmetic, at.input(0), at.input(1)));
}

/// Min and Max take any number of inputs.
template <OnnxArithmetic arithmetic>
void lower_extreme(OnnxLowering& at) {
  OnnxValue result = at.input(0);
  for (std::size_t i = 1; i < at.inputs(); ++i) result = at.combine(arithmetic, result, at.input(i));
  at.set_output(0, result);
}

void lower_neg(OnnxLowering& at) { at.set_output(0, scaled(at, at.input(0), -1.0f)); }

template <OnnxFunction function>
void lower_map(OnnxLowering& at) {
  at.set_output(0, at.map(at.input(0), function));
}

void lower_leaky_relu(OnnxLowering& at) {
  at.set_output(0, at.map(at.input(0), OnnxFunction::kLeakyRelu, at.attribute("alpha", 0.01f)));
}

void lower_elu(OnnxLowering& at) {
  at.set_output(0, at.map(at.input(0), OnnxFunction::kElu, at.attribute("alpha", 1.0f)));
}

float clip_bound(const OnnxLowering& at, std::size_t index, float fallback) {
  if (!at.has_input(index)) return fallback;
  const std::vector<float>& bound = constant_floats(at, at.input(index), "bounds");
  if (bound.size() != 1 || std::isnan(bound[0])) at.fail("takes a bound that is not one number");
  return bound[0];
}

void lower_clip(OnnxLowering& at) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float low = clip_bound(at, 1, -kInfinity);
  const float high = clip_bound(at, 2, kInfinity);
  at.set_output(0, at.map(at.input(0), OnnxFunction::kClip, low, high));
}

constexpr OnnxOperator kArithmetic[] = {
    {"Add", 2, 2, lower_combine<OnnxArithmetic::kAdd>},
    {"Clip", 1, 3, lower_clip},
    {"Div", 2, 2, lower_combine<OnnxArithmetic::kDiv>},
    {"Elu", 1, 1, lower_elu},
    {"Exp", 1, 1, lower_map<OnnxFunction::kExp>},
    {"Gemm", 2, 3, lower_gemm},
    {"LeakyRelu", 1, 1, lower_leaky_relu},
    {"MatMul", 2, 2, lower_matmul},
    {"Max", 1, kAnyInputs, lower_extreme<OnnxArithmetic::kMax>},
    {"Min", 1, kAnyInputs, lower_extreme<OnnxArithmetic::kMin>},
    {"Mul", 2, 2, lower_combine<OnnxArithmetic::kMul>},
    {"Neg", 1, 1, lower_neg},
    {"Relu", 1, 1, lower_map<OnnxFunction::kRelu>},
    {"Sigmoid", 1, 1, lower_map<OnnxFunction::kSigmoid>},
    {"Softplus", 1, 1, lower_map<OnnxFunction::kSoftplus>},
    {"Sqrt", 1, 1, lower_map<OnnxFunction::kSqrt>},
    {"Sub", 2, 2, lower_combine<OnnxArithmetic::kSub>},
    {"Tanh", 1, 1, lower_map<OnnxFunction::kTanh>},
};

}  // namespace

std::span<const OnnxOperator> onnx_arithmetic_operators() { return kArithmetic; }

const OnnxOperator* find_onnx_operator(std::string_view name) {
  for (const auto operators : {onnx_arithmetic_operators(), onnx_shape_operators(), onnx_selection_operators()}) {
    for (const OnnxOperator& op : operators) {
      if (op.name == name) return &op;
    }
  }
  return nullptr;
}

std::string onnx_operator_names() {
  std::vector<std::string> names;
  for (const auto operators : {onnx_arithmetic_operators(), onnx_shape_operators(), onnx_selection_operators()}) {
    for (const OnnxOperator& op : operators) names.emplace_back(op.name);
  }
  std::sort(names.begin(), names.end());
  return join(names, ", ");
}

}  // namespace gust
