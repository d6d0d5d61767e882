#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/operators.h"

// Operators that multiply matrices.

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

OnnxValue scaled(OnnxLowering& at, const OnnxValue& value, float factor) {
  return factor == 1.0f ? value : at.combine(OnnxArithmetic::kMul, value, at.number(factor));
}

/// The order of the axes that swaps the last two.
std::vector<std::size_t> last_two_swapped(const OnnxValue& value) {
  std::vector<std::size_t> order(value.dims.size());
  std::iota(order.begin(), order.end(), 0);
  std::swap(order[order.size() - 1], order[order.size() - 2]);
  return order;
}

OnnxValue with_axis(OnnxLowering& at, const OnnxValue& value, std::size_t place) {
  OnnxDims dims = value.dims;
  dims.insert(dims.begin() + static_cast<std::ptrdiff_t>(place), 1);
  return at.reshaped(value, dims);
}

/// Sums of products, where no matrix of weights is constant: of left [..., i, k] and right [..., k, j].
OnnxValue product_of_values(OnnxLowering& at, const OnnxValue& left, const OnnxValue& right) {
  const OnnxValue columns = at.transposed(right, last_two_swapped(right));
  if (left.dims.back() == kOnnxBatch || columns.dims.back() == kOnnxBatch) {
    at.fail("multiplies across the batch; every lane must stay by itself");
  }
  if (left.dims.back() != columns.dims.back()) {
    at.fail(cat("multiplies ", left.dims.back(), " numbers with ", columns.dims.back()));
  }
  const OnnxValue rows = with_axis(at, left, left.dims.size() - 1);
  const OnnxValue pairs = at.combine(OnnxArithmetic::kMul, rows, with_axis(at, columns, columns.dims.size() - 2));
  OnnxValue sums = at.reduce(OnnxReduction::kSum, pairs, {pairs.dims.size() - 1});
  OnnxDims dims = sums.dims;
  dims.pop_back();
  return at.reshaped(std::move(sums), dims);
}

/// The product of two values of two or more dimensions. A constant matrix on either side becomes a layer.
OnnxValue product_of_matrices(OnnxLowering& at, const OnnxValue& left, const OnnxValue& right) {
  if (right.constant != nullptr && right.dims.size() == 2) {
    Weights weights = read_weights(at, right, false, 1.0f);
    check_product(at, left, weights.inputs);
    std::vector<float> bias(weights.outputs, 0.0f);
    return at.dense(left, std::move(weights.values), std::move(bias));
  }
  if (left.constant != nullptr && left.dims.size() == 2) {
    Weights weights = read_weights(at, left, true, 1.0f);
    const OnnxValue columns = at.transposed(right, last_two_swapped(right));
    check_product(at, columns, weights.inputs);
    std::vector<float> bias(weights.outputs, 0.0f);
    const OnnxValue product = at.dense(columns, std::move(weights.values), std::move(bias));
    return at.transposed(product, last_two_swapped(product));
  }
  return product_of_values(at, left, right);
}

/// alpha A' B' + beta C where B depends on the observation.
void lower_gemm_of_values(OnnxLowering& at, const OnnxValue& from, bool transposed) {
  OnnxValue right = at.input(1);
  if (right.dims.size() != 2)
    at.fail(cat("takes a matrix, but its second input has ", right.dims.size(), " dimensions"));
  if (transposed) right = at.transposed(right, {1, 0});
  const OnnxValue product = scaled(at, product_of_matrices(at, from, right), at.attribute("alpha", 1.0f));
  const float beta = at.attribute("beta", 1.0f);
  if (!at.has_input(2) || beta == 0.0f) return at.set_output(0, product);
  at.set_output(0, at.combine(OnnxArithmetic::kAdd, product, scaled(at, at.input(2), beta)));
}

/// alpha A' B' + beta C; the factors go into the weights and the bias.
void lower_gemm(OnnxLowering& at) {
  OnnxValue from = at.input(0);
  if (from.dims.size() != 2) at.fail(cat("takes a matrix, but its first input has ", from.dims.size(), " dimensions"));
  if (at.attribute("transA", std::int64_t{0}) != 0) from = at.transposed(from, {1, 0});
  const bool transposed = at.attribute("transB", std::int64_t{0}) != 0;
  if (at.input(1).constant == nullptr) return lower_gemm_of_values(at, from, transposed);
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

/// A vector on either side counts as a matrix of one row or column, which the result lacks.
void lower_matmul(OnnxLowering& at) {
  OnnxValue left = at.input(0);
  OnnxValue right = at.input(1);
  if (left.dims.empty() || right.dims.empty()) at.fail("multiplies a value without dimensions");
  const bool row = left.dims.size() == 1;
  const bool column = right.dims.size() == 1;
  if (row) left = with_axis(at, left, 0);
  if (column) right = with_axis(at, right, 1);
  OnnxValue product = product_of_matrices(at, left, right);
  OnnxDims dims = product.dims;
  if (column) dims.pop_back();
  if (row) dims.erase(dims.end() - (column ? 1 : 2));
  at.set_output(0, at.reshaped(std::move(product), dims));
}

/// scikit-learn's linear models: x W' + b, with W and b as attributes.
void lower_linear_regressor(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const auto weights = at.attribute("coefficients", std::vector<float>{});
  const auto bias = at.attribute("intercepts", std::vector<float>{});
  const std::int64_t targets = at.attribute("targets", std::int64_t{1});
  if (targets < 1 || weights.size() % static_cast<std::size_t>(targets) != 0) at.fail("has no such coefficients");
  if (at.attribute("post_transform", std::string("NONE")) != "NONE") at.fail("transforms what it gives; NONE is read");
  const auto inputs = static_cast<std::int64_t>(weights.size()) / targets;
  const OnnxValue matrix = at.constant({.dims = {targets, inputs}, .floats = weights, .integers = {}});
  const OnnxValue product = product_of_matrices(at, from, at.transposed(matrix, {1, 0}));
  if (bias.empty()) return at.set_output(0, product);
  const OnnxDims row = {static_cast<std::int64_t>(bias.size())};
  at.set_output(0,
                at.combine(OnnxArithmetic::kAdd, product, at.constant({.dims = row, .floats = bias, .integers = {}})));
}

constexpr OnnxOperator kProducts[] = {
    {"Gemm", 2, 3, lower_gemm},
    {"MatMul", 2, 2, lower_matmul},
    {"ai.onnx.ml.LinearRegressor", 1, 1, lower_linear_regressor},
};

}  // namespace

std::span<const OnnxOperator> onnx_product_operators() { return kProducts; }

}  // namespace gust
