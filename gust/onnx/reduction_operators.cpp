#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/operators.h"

// Operators that take numbers of a lane together: sums, means, normalisations. None may reach across the batch.

namespace gust {
namespace {

/// The axes along which a node reduces; all if it names none.
std::vector<std::size_t> reduced_axes(const OnnxLowering& at, std::size_t rank) {
  std::vector<std::size_t> axes;
  for (const std::int64_t index : at.integers(1, "axes")) axes.push_back(at.axis(index, rank));
  const bool all = axes.empty() && at.attribute("noop_with_empty_axes", std::int64_t{0}) == 0;
  if (all) axes.resize(rank);
  if (all) std::iota(axes.begin(), axes.end(), 0);
  return axes;
}

OnnxValue without_axes(OnnxLowering& at, OnnxValue value, const std::vector<std::size_t>& axes) {
  OnnxDims dims;
  for (std::size_t axis = 0; axis < value.dims.size(); ++axis) {
    if (std::find(axes.begin(), axes.end(), axis) == axes.end()) dims.push_back(value.dims[axis]);
  }
  return at.reshaped(std::move(value), dims);
}

/// The reduction of all integers of a constant, such as the product of some sizes.
void lower_reduced_sizes(OnnxLowering& at, OnnxArithmetic arithmetic) {
  const OnnxTensor& from = *at.input(0).constant;
  if (from.integers.empty() || from.dims.size() > 1) at.fail("reduces integers that are no list of sizes");
  std::int64_t result = from.integers[0];
  for (std::size_t i = 1; i < from.integers.size(); ++i) {
    if (!integer_result(arithmetic, result, from.integers[i], result)) at.fail("computes a size that is no integer");
  }
  const bool keeps = at.attribute("keepdims", std::int64_t{1}) != 0 && !from.dims.empty();
  at.set_output(
      0, at.constant({.dims = OnnxDims(keeps ? 1 : 0, 1), .floats = {}, .integers = {result}, .integral = true}));
}

template <OnnxReduction reduction>
void lower_reduce(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  if (from.constant != nullptr && from.integral()) {
    if (reduction == OnnxReduction::kSum) return lower_reduced_sizes(at, OnnxArithmetic::kAdd);
    if (reduction == OnnxReduction::kProduct) return lower_reduced_sizes(at, OnnxArithmetic::kMul);
    if (reduction == OnnxReduction::kMin) return lower_reduced_sizes(at, OnnxArithmetic::kMin);
    if (reduction == OnnxReduction::kMax) return lower_reduced_sizes(at, OnnxArithmetic::kMax);
  }
  const std::vector<std::size_t> axes = reduced_axes(at, from.dims.size());
  if (axes.empty()) return at.set_output(0, from);
  OnnxValue result = at.reduce(reduction, from, axes);
  if (at.attribute("keepdims", std::int64_t{1}) == 0) result = without_axes(at, std::move(result), axes);
  at.set_output(0, result);
}

/// The logarithm of a sum, or of a sum of powers of e; these are taken of the distance to the largest number, so that
/// none overflows.
template <bool of_powers>
void lower_reduced_logarithm(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::vector<std::size_t> axes = reduced_axes(at, from.dims.size());
  if (axes.empty()) at.fail("names no axis; a logarithm of sums needs one");
  OnnxValue result;
  if (of_powers) {
    const OnnxValue largest = at.reduce(OnnxReduction::kMax, from, axes);
    const OnnxValue powers = at.map(at.combine(OnnxArithmetic::kSub, from, largest), OnnxFunction::kExp);
    const OnnxValue logarithm = at.map(at.reduce(OnnxReduction::kSum, powers, axes), OnnxFunction::kLog);
    result = at.combine(OnnxArithmetic::kAdd, logarithm, largest);
  } else {
    result = at.map(at.reduce(OnnxReduction::kSum, from, axes), OnnxFunction::kLog);
  }
  if (at.attribute("keepdims", std::int64_t{1}) == 0) result = without_axes(at, std::move(result), axes);
  at.set_output(0, result);
}

/// The numbers from an axis on, which a normalisation takes together.
std::size_t run_from(const OnnxLowering& at, const OnnxDims& dims, std::size_t axis) {
  const OnnxDims rest(dims.begin() + static_cast<std::ptrdiff_t>(axis), dims.end());
  if (std::find(rest.begin(), rest.end(), kOnnxBatch) != rest.end()) {
    at.fail("works along the batch; every lane must stay by itself");
  }
  return at.elements(rest);
}

OnnxValue scaled_and_shifted(OnnxLowering& at, OnnxValue value, const OnnxValue* scale, const OnnxValue* shift) {
  if (scale != nullptr) value = at.combine(OnnxArithmetic::kMul, value, *scale);
  if (shift != nullptr) value = at.combine(OnnxArithmetic::kAdd, value, *shift);
  return value;
}

template <bool centred>
void lower_layer_normalization(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::size_t axis = at.axis(at.attribute("axis", std::int64_t{-1}), from.dims.size());
  const OnnxValue plain = at.normalise(from, run_from(at, from.dims, axis), at.attribute("epsilon", 1e-5f), centred);
  const OnnxValue* shift = at.has_input(2) ? &at.input(2) : nullptr;
  at.set_output(0, scaled_and_shifted(at, plain, &at.input(1), shift));
}

/// A number per channel, as a value that fits an input whose second axis are the channels. That axis may be the batch,
/// as where Keras 2 normalises a layer; a constant is then the same for every lane.
OnnxValue per_channel(OnnxLowering& at, std::size_t index, const OnnxDims& dims) {
  const OnnxValue& value = at.input(index);
  const bool fits = dims.size() > 1 && value.dims.size() == 1 &&
                    (value.dims[0] == dims[1] || (value.constant != nullptr && value.dims[0] == lane_size(dims[1])));
  if (!fits) at.fail("has numbers per channel that do not fit the second dimension of its input");
  OnnxDims wide(dims.size() - 1, 1);
  wide[0] = value.dims[0];
  return at.reshaped(value, wide);
}

/// What the training has measured is subtracted and divided by.
void lower_batch_normalization(OnnxLowering& at) {
  if (at.attribute("training_mode", std::int64_t{0}) != 0) {
    at.fail("is in training mode and normalises by the batch; call model.eval() before the export");
  }
  const OnnxValue from = at.input(0);
  const OnnxDims dims = from.dims;
  const OnnxValue variance = per_channel(at, 4, dims);
  const OnnxValue raised = at.combine(OnnxArithmetic::kAdd, variance, at.number(at.attribute("epsilon", 1e-5f)));
  const OnnxValue deviation = at.map(raised, OnnxFunction::kSqrt);
  const OnnxValue scale = at.combine(OnnxArithmetic::kDiv, per_channel(at, 1, dims), deviation);
  const OnnxValue centred = at.combine(OnnxArithmetic::kSub, from, per_channel(at, 3, dims));
  const OnnxValue shift = per_channel(at, 2, dims);
  at.set_output(0, scaled_and_shifted(at, centred, &scale, &shift));
}

void lower_instance_normalization(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  if (from.dims.size() < 3) at.fail("takes a value of three or more dimensions");
  const OnnxValue plain =
      at.normalise(from, run_from(at, from.dims, 2), at.attribute("epsilon", 1e-5f), /*centred=*/true);
  const OnnxValue scale = per_channel(at, 1, from.dims);
  const OnnxValue shift = per_channel(at, 2, from.dims);
  at.set_output(0, scaled_and_shifted(at, plain, &scale, &shift));
}

/// Numbers that lie together in a group, of a value whose second axis are the channels.
void lower_group_normalization(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::int64_t groups = at.attribute("num_groups", std::int64_t{0});
  if (from.dims.size() < 2 || groups < 1 || from.dims[1] < 1 || from.dims[1] % groups != 0) {
    at.fail("has a number of groups that does not divide the channels of its input");
  }
  const std::size_t run = run_from(at, from.dims, 1) / static_cast<std::size_t>(groups);
  const OnnxValue plain = at.normalise(from, run, at.attribute("epsilon", 1e-5f), /*centred=*/true);
  OnnxDims per_group = from.dims;  // before opset 21 a scale belonged to a group
  if (at.opset() < 21) per_group = {from.dims[0], groups, static_cast<std::int64_t>(run)};
  const OnnxValue scale = per_channel(at, 1, per_group);
  const OnnxValue shift = per_channel(at, 2, per_group);
  OnnxValue result = scaled_and_shifted(at, at.reshaped(plain, per_group), &scale, &shift);
  at.set_output(0, at.reshaped(std::move(result), from.dims));
}

/// Numbers along an axis divided by their length, or by the sum of their sizes. Zeros stay zeros, as in onnxruntime.
OnnxValue scaled_to_one(OnnxLowering& at, const OnnxValue& from, std::size_t axis, OnnxReduction reduction) {
  const OnnxValue length = at.reduce(reduction, from, {axis});
  return at.combine(OnnxArithmetic::kDiv, from, at.choose(length, length, at.number(1.0f)));
}

void lower_lp_normalization(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::size_t axis = at.axis(at.attribute("axis", std::int64_t{-1}), from.dims.size());
  const std::int64_t power = at.attribute("p", std::int64_t{2});
  if (power != 1 && power != 2) at.fail("has a power other than 1 and 2");
  at.set_output(0, scaled_to_one(at, from, axis, power == 1 ? OnnxReduction::kSumOfSizes : OnnxReduction::kLength));
}

/// scikit-learn's Normalizer, along the last axis.
void lower_normalizer(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::string norm = at.attribute("norm", std::string("MAX"));
  if (norm != "L1" && norm != "L2") at.fail("has a norm other than L1 and L2");
  const std::size_t axis = at.axis(-1, from.dims.size());
  at.set_output(0, scaled_to_one(at, from, axis, norm == "L1" ? OnnxReduction::kSumOfSizes : OnnxReduction::kLength));
}

/// The mean of every channel.
void lower_global_average_pool(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  if (from.dims.size() < 3) at.fail("takes a value of three or more dimensions");
  std::vector<std::size_t> axes(from.dims.size() - 2);
  std::iota(axes.begin(), axes.end(), 2);
  at.set_output(0, at.reduce(OnnxReduction::kMean, from, axes));
}

/// Before opset 13 it took all axes from the one that is named on; that is the same where this is the last.
std::size_t softmax_axis(const OnnxLowering& at, const OnnxDims& dims) {
  const bool old = at.opset() < 13;
  const std::size_t axis = at.axis(at.attribute("axis", std::int64_t{old ? 1 : -1}), dims.size());
  if (old && axis + 1 != dims.size()) at.fail("takes several axes together; only the last is supported");
  return axis;
}

template <bool logarithm>
void lower_softmax(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::vector<std::size_t> axis = {softmax_axis(at, from.dims)};
  const OnnxValue shifted = at.combine(OnnxArithmetic::kSub, from, at.reduce(OnnxReduction::kMax, from, axis));
  const OnnxValue powers = at.map(shifted, OnnxFunction::kExp);
  const OnnxValue sum = at.reduce(OnnxReduction::kSum, powers, axis);
  if (!logarithm) return at.set_output(0, at.combine(OnnxArithmetic::kDiv, powers, sum));
  at.set_output(0, at.combine(OnnxArithmetic::kSub, shifted, at.map(sum, OnnxFunction::kLog)));
}

constexpr OnnxOperator kReductions[] = {
    {"BatchNormalization", 5, 5, lower_batch_normalization},
    {"GlobalAveragePool", 1, 1, lower_global_average_pool},
    {"GroupNormalization", 3, 3, lower_group_normalization},
    {"InstanceNormalization", 3, 3, lower_instance_normalization},
    {"LayerNormalization", 2, 3, lower_layer_normalization<true>},
    {"LogSoftmax", 1, 1, lower_softmax<true>},
    {"LpNormalization", 1, 1, lower_lp_normalization},
    {"RMSNormalization", 2, 2, lower_layer_normalization<false>},
    {"ReduceL1", 1, 2, lower_reduce<OnnxReduction::kSumOfSizes>},
    {"ReduceL2", 1, 2, lower_reduce<OnnxReduction::kLength>},
    {"ReduceLogSum", 1, 2, lower_reduced_logarithm<false>},
    {"ReduceLogSumExp", 1, 2, lower_reduced_logarithm<true>},
    {"ReduceMax", 1, 2, lower_reduce<OnnxReduction::kMax>},
    {"ReduceMean", 1, 2, lower_reduce<OnnxReduction::kMean>},
    {"ReduceMin", 1, 2, lower_reduce<OnnxReduction::kMin>},
    {"ReduceProd", 1, 2, lower_reduce<OnnxReduction::kProduct>},
    {"ReduceSum", 1, 2, lower_reduce<OnnxReduction::kSum>},
    {"ReduceSumSquare", 1, 2, lower_reduce<OnnxReduction::kSumOfSquares>},
    {"Softmax", 1, 1, lower_softmax<false>},
    {"ai.onnx.ml.Normalizer", 1, 1, lower_normalizer},
};

}  // namespace

std::span<const OnnxOperator> onnx_reduction_operators() { return kReductions; }

}  // namespace gust
