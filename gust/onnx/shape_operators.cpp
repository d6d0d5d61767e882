#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/operators.h"

namespace gust {
namespace {

/// Whether the first dimension is the batch. Sizes are only put together where it is, or where there is none.
bool batched(const OnnxLowering& at, const OnnxDims& dims) {
  const auto batch = std::find(dims.begin(), dims.end(), kOnnxBatch);
  if (batch != dims.end() && batch != dims.begin()) {
    at.fail("gives another shape to a value whose first dimension is not the batch");
  }
  return batch != dims.end();
}

std::int64_t product(OnnxDims::const_iterator from, OnnxDims::const_iterator to) {
  return std::accumulate(from, to, std::int64_t{1},
                         [](std::int64_t a, std::int64_t dim) { return a * lane_size(dim); });
}

void lower_identity(OnnxLowering& at) { at.set_output(0, at.input(0)); }

/// Drops nothing when a policy acts.
void lower_dropout(OnnxLowering& at) {
  const bool trains = at.has_input(2) && at.input(2).constant != nullptr && at.input(2).constant->integral &&
                      at.input(2).constant->integers != std::vector<std::int64_t>{0};
  if (trains) at.fail("is in training mode and drops numbers at random; call model.eval() before the export");
  at.set_output(0, at.input(0));
}

/// The numbers of a constant as integers, rounded towards 0.
OnnxValue as_integers(OnnxLowering& at, const OnnxTensor& from) {
  OnnxTensor tensor{.dims = from.dims, .floats = {}, .integers = {}, .integral = true};
  for (const float value : from.floats) {
    if (!(std::fabs(value) < 0x1p62f)) at.fail("casts a number to an integer that there is not");
    tensor.integers.push_back(static_cast<std::int64_t>(value));
  }
  return at.constant(std::move(tensor));
}

/// 1 where a number is not 0.
OnnxValue as_truths(OnnxLowering& at, OnnxValue value) {
  value = at.as_floats(value);
  value.whole = false;
  return at.map(at.map(value, OnnxFunction::kNot), OnnxFunction::kNot);
}

/// What a value is cast to. Integers of any width are one kind, and floats of any width.
enum class Kind { kFloats, kIntegers, kTruths };

OnnxValue cast(OnnxLowering& at, OnnxValue value, Kind kind) {
  if (kind == Kind::kTruths) return as_truths(at, value);
  if (kind == Kind::kFloats) {
    value = at.as_floats(value);
    value.whole = value.truth = false;
  } else if (value.constant != nullptr) {
    if (!value.integral()) value = as_integers(at, *value.constant);
  } else if (!value.integral()) {
    value = at.map(value, OnnxFunction::kTruncate);
    value.whole = true;
  }
  return value;
}

void lower_cast(OnnxLowering& at) {
  constexpr std::int64_t kFloat = 1, kInt32 = 6, kInt64 = 7, kBool = 9, kDouble = 11;  // TensorProto.DataType
  const std::int64_t to = at.attribute("to", std::int64_t{0});
  const bool floats = to == kFloat || to == kDouble;
  if (!floats && to != kBool && to != kInt32 && to != kInt64) {
    at.fail(cat("casts to type ", to, "; supported are float32 (1), int32 (6), int64 (7), bool (9) and float64 (11)"));
  }
  at.set_output(0, cast(at, at.input(0), floats ? Kind::kFloats : to == kBool ? Kind::kTruths : Kind::kIntegers));
}

/// To the type of another value.
void lower_cast_like(OnnxLowering& at) {
  const OnnxValue& like = at.input(1);
  const Kind kind = like.is_truth() ? Kind::kTruths : like.integral() ? Kind::kIntegers : Kind::kFloats;
  at.set_output(0, cast(at, at.input(0), kind));
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
  OnnxValue value = at.constant(std::move(tensor));
  value.literal = true;
  at.set_output(0, value);
}

void lower_flatten(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  const std::int64_t index = at.attribute("axis", std::int64_t{1});
  const auto rank = static_cast<std::int64_t>(from.dims.size());
  const std::int64_t axis = index == rank ? rank : static_cast<std::int64_t>(at.axis(index, from.dims.size()));
  const bool has_batch = batched(at, from.dims);
  if (has_batch && axis != 1) at.fail("flattens the batch into the values; the axis must be 1");
  const auto middle = from.dims.begin() + axis;
  const std::int64_t first = has_batch ? kOnnxBatch : product(from.dims.begin(), middle);
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
    if (dims[i] < -1 || (dims[i] == -1 && open != nullptr)) at.fail("asks for an impossible shape");
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

/// Which of the sizes of a target shape is the batch. As many numbers lie before it as in the input, so that the
/// numbers of a lane stay together and in their order.
std::size_t batch_place(const OnnxLowering& at, const OnnxDims& dims, std::int64_t outer) {
  std::int64_t before = 1;
  for (std::size_t i = 0; i < dims.size(); ++i) {
    const bool may_be = dims[i] == kOnnxBatch || (dims[i] > 0 && dims[i] == at.fixed_batch());
    if (before == outer && may_be) return i;
    if (dims[i] < 1 || before > outer) break;
    before *= static_cast<std::int64_t>(at.elements({dims[i]}));
  }
  at.fail("joins the batch with other dimensions; every lane must stay by itself");
}

void lower_reshape(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  OnnxDims dims = with_copied_sizes(at, from.dims, at.integers(1, "shape"));
  const bool literal = at.has_input(1) && at.input(1).literal;
  if (literal && std::ranges::count(at.integers(1, "shape"), -1) > 1)
    at.fail("asks for an impossible shape: two of its sizes are -1");
  if (dims.size() > static_cast<std::size_t>(kOnnxRank)) at.fail("asks for a shape of too many dimensions");
  const auto batch = std::find(from.dims.begin(), from.dims.end(), kOnnxBatch);
  if (batch == from.dims.end()) {
    infer_size(at, dims, 0, static_cast<std::int64_t>(at.elements(from.dims)));
    return at.set_output(0, at.reshaped(from, dims));
  }
  const std::size_t place = batch_place(at, dims, product(from.dims.begin(), batch));
  dims[place] = kOnnxBatch;
  infer_size(at, dims, place + 1, product(batch, from.dims.end()));
  at.set_output(0, at.reshaped(from, dims));
}

void lower_squeeze(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  const std::vector<std::int64_t> axes = at.integers(1, "axes");
  std::vector<bool> dropped(from.dims.size(), false);
  for (const std::int64_t index : axes) dropped[at.axis(index, from.dims.size())] = true;
  OnnxDims dims;
  for (std::size_t i = 0; i < from.dims.size(); ++i) {
    if (dropped[i] && from.dims[i] != 1) at.fail(cat("drops the axis ", i, ", whose size is not 1"));
    const bool drop = axes.empty() ? from.dims[i] == 1 : dropped[i];
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
  std::replace(dims.begin(), dims.end(), kOnnxBatch, std::int64_t{1});
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

/// Integers from the first to the second, which is not among them; the third is the step. All three are constant.
void lower_range(OnnxLowering& at) {
  std::int64_t numbers[3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<std::int64_t> integers = at.integers(i, "range");
    if (integers.size() != 1) at.fail("takes a bound that is not one number");
    numbers[i] = integers[0];
  }
  const auto [start, end, step] = numbers;
  constexpr auto kMost = static_cast<std::int64_t>(kOnnxElements);
  const auto is_moderate = [](std::int64_t number) { return number >= -kMost && number <= kMost; };
  if (step == 0 || !std::all_of(std::begin(numbers), std::end(numbers), is_moderate)) {
    at.fail(
        cat("goes from ", start, " to ", end, " in steps of ", step, "; the limit is ", kMost, ", and no step is 0"));
  }
  OnnxTensor tensor{.dims = {}, .floats = {}, .integers = {}, .integral = true};
  for (std::int64_t i = start; step > 0 ? i < end : i > end; i += step) tensor.integers.push_back(i);
  tensor.dims = {static_cast<std::int64_t>(tensor.integers.size())};
  at.set_output(0, at.constant(std::move(tensor)));
}

void lower_expand(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  const OnnxDims target = from.constant != nullptr ? constant_dims(at, 1) : at.integers(1, "shape");
  if (target.size() > static_cast<std::size_t>(kOnnxRank)) at.fail("asks for a shape of too many dimensions");
  at.set_output(0, at.broadcast(from, at.broadcast_dims(from.dims, target)));
}

constexpr OnnxOperator kShape[] = {
    {"Cast", 1, 1, lower_cast},           {"CastLike", 2, 2, lower_cast_like},
    {"Constant", 0, 0, lower_constant},   {"ConstantOfShape", 1, 1, lower_constant_of_shape},
    {"Dropout", 1, 3, lower_dropout},     {"Expand", 2, 2, lower_expand},
    {"Flatten", 1, 1, lower_flatten},     {"Identity", 1, 1, lower_identity},
    {"Range", 3, 3, lower_range},         {"Reshape", 2, 2, lower_reshape},
    {"Shape", 1, 1, lower_shape},         {"Squeeze", 1, 2, lower_squeeze},
    {"Unsqueeze", 1, 2, lower_unsqueeze},
};

}  // namespace

std::span<const OnnxOperator> onnx_shape_operators() { return kShape; }

}  // namespace gust
