#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "gust/core/error.h"
#include "gust/nn/onnx_operators.h"

namespace gust {
namespace {

bool batched(const OnnxDims& dims) { return !dims.empty() && dims[0] == kOnnxBatch; }

std::int64_t size_of(std::int64_t dim) { return dim == kOnnxBatch ? 1 : dim; }

std::int64_t product(OnnxDims::const_iterator from, OnnxDims::const_iterator to) {
  return std::accumulate(from, to, std::int64_t{1}, [](std::int64_t a, std::int64_t dim) { return a * size_of(dim); });
}

void lower_identity(OnnxLowering& at) { at.set_output(0, at.input(0)); }

void lower_cast(OnnxLowering& at) {
  constexpr std::int64_t kFloat = 1, kInt64 = 7, kDouble = 11;  // TensorProto.DataType
  const std::int64_t to = at.attribute("to", std::int64_t{0});
  const OnnxValue& from = at.input(0);
  const bool integral = from.constant != nullptr && from.constant->integral;
  const bool to_float = to == kFloat || to == kDouble;
  if ((to_float && !integral) || (to == kInt64 && integral)) return at.set_output(0, from);
  if (from.constant == nullptr || !(to_float || to == kInt64)) {
    at.fail(cat("casts to type ", to, "; only float32 (1), float64 (11) and, for constants, int64 (7) are supported"));
  }
  OnnxTensor tensor{.dims = from.dims, .floats = {}, .integers = {}, .integral = to == kInt64};
  for (const std::int64_t value : from.constant->integers) tensor.floats.push_back(static_cast<float>(value));
  for (const float value : from.constant->floats) {
    if (!(std::fabs(value) < 0x1p62f)) at.fail("casts a number to int64 that is none");
    tensor.integers.push_back(static_cast<std::int64_t>(value));
  }
  at.set_output(0, at.constant(std::move(tensor)));
}

void lower_constant(OnnxLowering& at) {
  const auto size = [](const auto& list) { return OnnxDims{static_cast<std::int64_t>(list.size())}; };
  OnnxTensor tensor;
  if (at.find_attribute("value") != nullptr) {
    tensor = at.attribute("value", OnnxTensor{});
  } else if (at.find_attribute("value_float") != nullptr) {
    tensor.floats = {at.attribute("value_float", 0.0f)};
  } else if (at.find_attribute("value_floats") != nullptr) {
    tensor.floats = at.attribute("value_floats", std::vector<float>{});
    tensor.dims = size(tensor.floats);
  } else if (at.find_attribute("value_int") != nullptr) {
    tensor.integers = {at.attribute("value_int", std::int64_t{0})};
    tensor.integral = true;
  } else if (at.find_attribute("value_ints") != nullptr) {
    tensor.integers = at.attribute("value_ints", std::vector<std::int64_t>{});
    tensor.dims = size(tensor.integers);
    tensor.integral = true;
  } else {
    at.fail("has no value, or one that is neither numbers nor integers");
  }
  at.set_output(0, at.constant(std::move(tensor)));
}

void lower_flatten(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  const std::int64_t index = at.attribute("axis", std::int64_t{1});
  const auto rank = static_cast<std::int64_t>(from.dims.size());
  const std::int64_t axis = index == rank ? rank : static_cast<std::int64_t>(at.axis(index, from.dims.size()));
  if (batched(from.dims) && axis != 1) at.fail("flattens the batch into the values; the axis must be 1");
  const auto middle = from.dims.begin() + axis;
  const std::int64_t first = batched(from.dims) ? kOnnxBatch : product(from.dims.begin(), middle);
  at.set_output(0, at.reshaped(from, {first, product(middle, from.dims.end())}));
}

/// Zeros of a target shape stand for the size of the input at that place.
OnnxDims with_copied_sizes(const OnnxLowering& at, const OnnxDims& from, OnnxDims target) {
  if (at.attribute("allowzero", std::int64_t{0}) != 0) return target;
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (target[i] != 0) continue;
    if (i >= from.size()) at.fail("copies a size that its input does not have");
    target[i] = from[i];
  }
  return target;
}

/// Replaces the one -1 from `begin` on by the size that is left of `count` elements.
void infer_size(const OnnxLowering& at, OnnxDims& dims, std::size_t begin, std::int64_t count) {
  std::int64_t known = 1;
  std::int64_t* open = nullptr;
  for (std::size_t i = begin; i < dims.size(); ++i) {
    if (dims[i] < -1 || (dims[i] == -1 && open != nullptr)) at.fail("asks for a shape that is none");
    if (dims[i] == -1) {
      open = &dims[i];
    } else {
      known *= static_cast<std::int64_t>(at.elements({dims[i]}));
      if (known > static_cast<std::int64_t>(kOnnxElements)) at.fail("asks for a shape that is too large");
    }
  }
  if (open != nullptr && known != 0 && count % known == 0) *open = count / known;
  if (open == nullptr ? known == count : *open >= 0) return;
  at.fail(cat("cannot give the ", count, " numbers of a lane the shape that it asks for"));
}

void lower_reshape(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  OnnxDims dims = with_copied_sizes(at, from.dims, at.integers(1, "shape"));
  if (dims.size() > static_cast<std::size_t>(kOnnxRank)) at.fail("asks for a shape of too many dimensions");
  const auto count = static_cast<std::int64_t>(at.elements(from.dims));
  const bool keeps_batch =
      batched(from.dims) && !dims.empty() && (dims[0] == kOnnxBatch || (dims[0] > 0 && dims[0] == at.fixed_batch()));
  if (batched(from.dims) && !keeps_batch) at.fail("moves the batch away from the first dimension");
  if (keeps_batch) dims[0] = kOnnxBatch;
  infer_size(at, dims, keeps_batch ? 1 : 0, count);
  at.set_output(0, at.reshaped(from, dims));
}

void lower_squeeze(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  const std::vector<std::int64_t> axes = at.integers(1, "axes");
  const auto is_one = [&](std::int64_t dim) { return dim == 1 || (dim == kOnnxBatch && at.fixed_batch() == 1); };
  std::vector<bool> dropped(from.dims.size(), false);
  for (const std::int64_t index : axes) dropped[at.axis(index, from.dims.size())] = true;
  OnnxDims dims;
  for (std::size_t i = 0; i < from.dims.size(); ++i) {
    if (dropped[i] && !is_one(from.dims[i])) at.fail(cat("drops the axis ", i, ", whose size is not 1"));
    const bool drop = axes.empty() ? is_one(from.dims[i]) : dropped[i];
    if (!drop) dims.push_back(from.dims[i]);
  }
  at.set_output(0, at.reshaped(from, dims));
}

void lower_unsqueeze(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  const std::vector<std::int64_t> axes = at.integers(1, "axes");
  const std::size_t rank = from.dims.size() + axes.size();
  if (rank > static_cast<std::size_t>(kOnnxRank)) at.fail("makes too many dimensions");
  std::vector<bool> added(rank, false);
  for (const std::int64_t index : axes) added[at.axis(index, rank)] = true;
  const auto ones = static_cast<std::size_t>(std::count(added.begin(), added.end(), true));
  if (ones != axes.size()) at.fail("names an axis twice");
  if (batched(from.dims) && added[0]) at.fail("moves the batch away from the first dimension");
  OnnxDims dims;
  auto next = from.dims.begin();
  for (const bool one : added) dims.push_back(one ? 1 : *next++);
  at.set_output(0, at.reshaped(from, dims));
}

/// The sizes as integers; kOnnxBatch stands for the batch there too, as a Reshape or Expand to them takes it.
void lower_shape(OnnxLowering& at) {
  const OnnxDims& dims = at.input(0).dims;
  const auto rank = static_cast<std::int64_t>(dims.size());
  const auto bound = [&](std::int64_t index) {
    return std::clamp<std::int64_t>(index < 0 ? index + rank : index, 0, rank);
  };
  const std::int64_t start = bound(at.attribute("start", std::int64_t{0}));
  const std::int64_t end = std::max(start, bound(at.attribute("end", rank)));
  OnnxTensor tensor{.dims = {end - start}, .floats = {}, .integers = {}, .integral = true};
  tensor.integers.assign(dims.begin() + start, dims.begin() + end);
  at.set_output(0, at.constant(std::move(tensor)));
}

/// A shape given by integers, in which the batch counts as one: what is constant is the same in every lane.
OnnxDims constant_dims(const OnnxLowering& at, std::size_t index) {
  OnnxDims dims = at.integers(index, "shape");
  if (!dims.empty() && dims[0] == kOnnxBatch) dims[0] = 1;
  return dims;
}

void lower_constant_of_shape(OnnxLowering& at) {
  const OnnxTensor zero{.dims = {1}, .floats = {0.0f}, .integers = {}};
  OnnxTensor value = at.attribute("value", zero);
  if (value.size() != 1) at.fail("has a value that is not one number");
  value.dims = constant_dims(at, 0);
  const std::size_t count = at.elements(value.dims);
  if (value.integral) {
    value.integers.resize(count, value.integers[0]);
  } else {
    value.floats.resize(count, value.floats[0]);
  }
  at.set_output(0, at.constant(std::move(value)));
}

void lower_expand(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  const OnnxDims target = from.constant != nullptr ? constant_dims(at, 1) : at.integers(1, "shape");
  if (target.size() > static_cast<std::size_t>(kOnnxRank)) at.fail("asks for a shape of too many dimensions");
  at.set_output(0, at.broadcast(from, at.broadcast_dims(from.dims, target)));
}

constexpr OnnxOperator kShape[] = {
    {"Cast", 1, 1, lower_cast},
    {"Constant", 0, 0, lower_constant},
    {"ConstantOfShape", 1, 1, lower_constant_of_shape},
    {"Expand", 2, 2, lower_expand},
    {"Flatten", 1, 1, lower_flatten},
    {"Identity", 1, 1, lower_identity},
    {"Reshape", 2, 2, lower_reshape},
    {"Shape", 1, 1, lower_shape},
    {"Squeeze", 1, 2, lower_squeeze},
    {"Unsqueeze", 1, 2, lower_unsqueeze},
};

}  // namespace

std::span<const OnnxOperator> onnx_shape_operators() { return kShape; }

}  // namespace gust
