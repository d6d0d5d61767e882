#include "gust/onnx/lowering.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "gust/core/error.h"
#include "gust/onnx/operators.h"

namespace gust {

OnnxLowering::OnnxLowering(OnnxGraph graph) : graph_(std::move(graph)) {}

OnnxProgram OnnxLowering::program() {
  values_[graph_.input] = {.dims = graph_.input_dims, .constant = nullptr, .buffer = add_buffer(graph_.input_dims)};
  for (auto& [name, tensor] : graph_.constants)
    values_[name] = {.dims = tensor.dims, .constant = &tensor, .buffer = 0, .literal = true};
  for (const OnnxNode& node : graph_.nodes) {
    node_ = &node;
    lower_node();
  }
  node_ = nullptr;
  const auto output = values_.find(graph_.output);
  if (output == values_.end()) fail("has fewer outputs than the graph uses");
  check_output(output->second);
  program_.result = output->second.buffer;
  program_.remove_unused();
  return std::move(program_);
}

void OnnxLowering::lower_node() {
  const OnnxOperator* op = find_onnx_operator(node_->op);
  if (op == nullptr) fail(onnx_way_out(node_->op));
  if (inputs() < op->least_inputs || inputs() > op->most_inputs) {
    fail(cat("has ", inputs(), " inputs; this operator takes ", op->least_inputs, " to ", op->most_inputs));
  }
  for (std::size_t i = 0; i < op->least_inputs; ++i) input(i);
  if (outputs() == 0) fail("has no output");
  op->lower(*this);
}

void OnnxLowering::check_output(const OnnxValue& output) const {
  const std::string what = cat(graph_.file, ": output ", onnx_quoted(graph_.output), ": ");
  if (output.constant != nullptr) throw Error(cat(what, "does not depend on the observation; a policy acts on it"));
  const OnnxDims& declared = graph_.output_dims;
  if (declared.size() != output.dims.size()) {
    if (declared.empty()) return;
    throw Error(cat(what, "has ", output.dims.size(), " dimensions, but the file declares ", declared.size()));
  }
  for (std::size_t i = 0; i < declared.size(); ++i) {
    const std::int64_t dim = output.dims[i];
    if (dim == kOnnxBatch || declared[i] <= 0 || declared[i] == dim) continue;
    throw Error(cat(what, "has the size ", dim, " where the file declares ", declared[i]));
  }
}

void OnnxLowering::fail(std::string_view what) const {
  const std::string where = node_ != nullptr ? node_->name : cat("output ", onnx_quoted(graph_.output));
  throw Error(cat(graph_.file, ": ", where, ": ", what));
}

bool OnnxLowering::has_input(std::size_t index) const { return index < inputs() && !node_->inputs[index].empty(); }

const OnnxValue& OnnxLowering::input(std::size_t index) const {
  if (!has_input(index)) fail(cat("lacks its input ", index + 1));
  const auto found = values_.find(node_->inputs[index]);
  if (found == values_.end()) {
    fail(cat("needs ", onnx_quoted(node_->inputs[index]), ", an output that its node does not have"));
  }
  return found->second;
}

void OnnxLowering::set_output(std::size_t index, OnnxValue value) {
  GUST_CHECK(index < outputs());
  if (!node_->outputs[index].empty()) values_[node_->outputs[index]] = std::move(value);
}

const OnnxAttribute* OnnxLowering::find_attribute(const std::string& name) const {
  const auto found = node_->attributes.find(name);
  return found == node_->attributes.end() ? nullptr : &found->second;
}

std::vector<std::int64_t> OnnxLowering::integers(std::size_t index, const std::string& attribute_name) const {
  if (!has_input(index)) return attribute(attribute_name, std::vector<std::int64_t>{});
  const OnnxValue& value = input(index);
  if (value.constant == nullptr || !value.constant->integral) {
    fail(cat("needs constant integers for ", onnx_quoted(attribute_name)));
  }
  return value.constant->integers;
}

std::size_t OnnxLowering::axis(std::int64_t index, std::size_t rank) const {
  const auto size = static_cast<std::int64_t>(rank);
  if (index < -size || index >= size) fail(cat("has the axis ", index, ", but its input has ", rank, " dimensions"));
  return static_cast<std::size_t>(index < 0 ? index + size : index);
}

std::size_t OnnxLowering::elements(const OnnxDims& dims) const {
  if (dims.size() > kOnnxRank) fail(cat("makes a value of ", dims.size(), " dimensions; the limit is ", kOnnxRank));
  std::size_t count = 1;
  bool empty = false;
  for (const std::int64_t dim : dims) {
    if (dim == kOnnxBatch) continue;
    if (dim < 0 || static_cast<std::uint64_t>(dim) > kOnnxElements) fail(cat("makes a value of the size ", dim));
    empty = empty || dim == 0;
    count *= static_cast<std::size_t>(std::max<std::int64_t>(dim, 1));
    if (count > kOnnxElements) {
      fail(cat("makes a value of more than ", kOnnxElements, " numbers, the limit for a policy"));
    }
  }
  return empty ? 0 : count;
}

OnnxValue OnnxLowering::constant(OnnxTensor tensor) {
  GUST_CHECK(elements(tensor.dims) == tensor.size());
  charge(tensor.size());
  const OnnxTensor& kept = computed_.emplace_back(std::move(tensor));
  return {.dims = kept.dims, .constant = &kept, .buffer = 0};
}

OnnxValue OnnxLowering::map(const OnnxValue& from, OnnxFunction function, float a, float b) {
  if (from.whole) fail("computes with integers that depend on the observation; cast them to float32 first");
  OnnxValue result = append_from(from, OnnxMap{.from = 0, .to = 0, .function = function, .a = a, .b = b}, from.dims);
  using enum OnnxFunction;
  result.truth = function == kNot || function == kIsNan || function == kIsInf;
  return result;
}

OnnxValue OnnxLowering::combine(OnnxArithmetic arithmetic, const OnnxValue& left, const OnnxValue& right) {
  const bool integral = left.integral() || right.integral();
  if (left.constant != nullptr && right.constant != nullptr && left.integral() && right.integral()) {
    return combine_integers(arithmetic, left, right);
  }
  if (left.integral() != right.integral() && arithmetic < OnnxArithmetic::kEqual) {
    fail("computes with integers and floats together; cast the integers to float32 first");
  }
  const bool rounds = arithmetic == OnnxArithmetic::kDiv || arithmetic == OnnxArithmetic::kPow;
  if (integral && rounds) fail("divides integers, or raises them to a power, where they depend on the observation");
  const OnnxDims dims = broadcast_dims(left.dims, right.dims);
  const OnnxValue a = broadcast(as_floats(left), dims);
  const OnnxValue b = broadcast(as_floats(right), dims);
  if (a.constant != nullptr && b.constant != nullptr) {
    std::vector<float> result(elements(dims));
    apply(arithmetic, floats(a).data(), floats(b).data(), result);
    return constant({.dims = dims, .floats = std::move(result), .integers = {}});
  }
  using enum OnnxArithmetic;
  const bool bounds = arithmetic == kMin || arithmetic == kMax || arithmetic >= kGreater;
  OnnxCombine step{
      .arithmetic = arithmetic, .left = operand(a, bounds), .right = operand(b, bounds), .to = add_buffer(dims)};
  const std::size_t buffer = step.to;
  OnnxValue result = append(std::move(step), buffer, dims);
  result.truth = arithmetic >= OnnxArithmetic::kGreater;
  result.whole = integral && !result.truth;
  return result;
}

OnnxValue OnnxLowering::combine_integers(OnnxArithmetic arithmetic, const OnnxValue& left, const OnnxValue& right) {
  const OnnxDims dims = broadcast_dims(left.dims, right.dims);
  const std::vector<std::int64_t>& a = broadcast(left, dims).constant->integers;
  const std::vector<std::int64_t>& b = broadcast(right, dims).constant->integers;
  std::vector<std::int64_t> result(elements(dims));
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!integer_result(arithmetic, a[i], b[i], result[i])) fail("computes a size that is no integer");
  }
  return constant({.dims = dims, .floats = {}, .integers = std::move(result), .integral = true});
}

OnnxValue OnnxLowering::choose(const OnnxValue& condition, const OnnxValue& left, const OnnxValue& right) {
  const OnnxDims dims = broadcast_dims(broadcast_dims(left.dims, right.dims), condition.dims);
  const OnnxValue c = broadcast(condition, dims);
  OnnxValue a = broadcast(left, dims);
  OnnxValue b = broadcast(right, dims);
  const bool integral = left.integral() || right.integral();
  if (c.constant != nullptr && a.constant != nullptr && b.constant != nullptr && a.integral() && b.integral()) {
    std::vector<std::int64_t> result = b.constant->integers;
    const std::vector<float> chosen = floats(as_floats(c));
    for (std::size_t i = 0; i < result.size(); ++i) {
      if (chosen[i] != 0.0f) result[i] = a.constant->integers[i];
    }
    return constant({.dims = dims, .floats = {}, .integers = std::move(result), .integral = true});
  }
  const OnnxValue values[] = {as_floats(c), as_floats(a), as_floats(b)};
  if (c.constant != nullptr && a.constant != nullptr && b.constant != nullptr) {
    std::vector<float> result(floats(values[1]).size());
    gust::choose(floats(values[0]).data(), floats(values[1]).data(), floats(values[2]).data(), result);
    return constant({.dims = dims, .floats = std::move(result), .integers = {}});
  }
  OnnxChoose step{.condition = operand(values[0], true),
                  .left = operand(values[1], true),
                  .right = operand(values[2], true),
                  .to = add_buffer(dims)};
  const std::size_t buffer = step.to;
  OnnxValue result = append(std::move(step), buffer, dims);
  result.whole = integral;
  result.truth = left.is_truth() && right.is_truth();
  return result;
}

OnnxValue OnnxLowering::dense(const OnnxValue& from, Buffer<float> weights, std::vector<float> bias) {
  OnnxDims dims = from.dims;
  const auto inputs = static_cast<std::size_t>(dims.back());
  const std::size_t outputs = bias.size();
  const std::size_t rows = inputs == 0 ? 0 : elements(from.dims) / inputs;
  dims.back() = static_cast<std::int64_t>(outputs);
  charge(weights.size());
  check_finite(weights);
  check_finite(bias);
  if (elements(dims) == 0 || inputs == 0) fail("multiplies matrices without elements");
  OnnxDense step{.from = 0,
                 .to = 0,
                 .rows = rows,
                 .inputs = inputs,
                 .outputs = outputs,
                 .weights = std::move(weights),
                 .bias = std::move(bias)};
  return append_from(from, std::move(step), std::move(dims));
}

OnnxValue OnnxLowering::reduce(OnnxReduction reduction, const OnnxValue& from, const std::vector<std::size_t>& axes) {
  std::vector<std::size_t> order;
  std::vector<std::size_t> last;
  OnnxDims dims = from.dims;
  std::size_t run = 1;
  for (std::size_t axis = 0; axis < dims.size(); ++axis) {
    const bool reduced = std::find(axes.begin(), axes.end(), axis) != axes.end();
    (reduced ? last : order).push_back(axis);
    if (!reduced) continue;
    if (dims[axis] == kOnnxBatch) fail("works along the batch; every lane must stay by itself");
    run *= static_cast<std::size_t>(std::exchange(dims[axis], 1));
  }
  if (run == 0 || elements(dims) == 0) fail("reduces a value without elements");
  if (from.whole) fail("reduces integers that depend on the observation; cast them to float32 first");
  order.insert(order.end(), last.begin(), last.end());
  const OnnxValue ordered = as_floats(transposed(from, order));
  const OnnxReduce step{.from = 0, .to = 0, .reduction = reduction, .run = run};
  return append_from(ordered, step, std::move(dims));
}

OnnxValue OnnxLowering::normalise(const OnnxValue& from, std::size_t run, float epsilon, bool centred) {
  if (run == 0 || elements(from.dims) % run != 0) fail("normalises a value without elements");
  const OnnxNormalise step{.from = 0, .to = 0, .run = run, .epsilon = epsilon, .centred = centred};
  return append_from(from, step, from.dims);
}

OnnxValue OnnxLowering::transposed(const OnnxValue& from, const std::vector<std::size_t>& order) {
  if (std::is_sorted(order.begin(), order.end())) return from;
  OnnxDims dims;
  std::vector<std::size_t> strides;
  for (const std::size_t axis : order) {
    dims.push_back(from.dims[axis]);
    std::size_t stride = 1;
    for (std::size_t i = axis + 1; i < from.dims.size(); ++i)
      stride *= static_cast<std::size_t>(lane_size(from.dims[i]));
    strides.push_back(stride);
  }
  std::vector<std::size_t> indices(elements(dims), 0);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    std::size_t rest = i;
    for (std::size_t axis = dims.size(); axis-- > 0;) {
      const auto size = static_cast<std::size_t>(lane_size(dims[axis]));
      indices[i] += rest % size * strides[axis];
      rest /= size;
    }
  }
  return pick(from, indices, std::move(dims));
}

OnnxValue OnnxLowering::as_floats(const OnnxValue& value) {
  if (value.constant == nullptr || !value.constant->integral) return value;
  const std::vector<std::int64_t>& integers = value.constant->integers;
  return constant({.dims = value.dims, .floats = {integers.begin(), integers.end()}, .integers = {}});
}

OnnxValue OnnxLowering::pick(const OnnxValue& from, const std::vector<std::size_t>& indices, OnnxDims dims) {
  if (from.constant == nullptr) {
    std::vector<OnnxPick::Source> sources;
    for (const std::size_t index : indices) sources.push_back({from.buffer, index});
    OnnxValue picked = pick_many(std::move(sources), std::move(dims));
    picked.whole = from.whole;
    picked.truth = from.truth;
    return picked;
  }
  OnnxTensor tensor{.dims = std::move(dims), .floats = {}, .integers = {}, .integral = from.constant->integral};
  for (const std::size_t index : indices) {
    if (tensor.integral) {
      tensor.integers.push_back(from.constant->integers[index]);
    } else {
      tensor.floats.push_back(from.constant->floats[index]);
    }
  }
  return constant(std::move(tensor));
}

OnnxValue OnnxLowering::filled(const OnnxValue& from) {
  const OnnxValue numbers = as_floats(from);
  check_finite(floats(numbers));
  const std::size_t buffer = add_buffer(from.dims);
  OnnxValue result = append(OnnxConstant{.to = buffer, .row = floats(numbers)}, buffer, from.dims);
  result.whole = from.integral();
  result.truth = from.is_truth();
  return result;
}

OnnxValue OnnxLowering::pick_many(std::vector<OnnxPick::Source> sources, OnnxDims dims) {
  const std::size_t buffer = add_buffer(dims);
  GUST_CHECK(sources.size() == program_.widths[buffer]);
  return append(OnnxPick{.to = buffer, .sources = std::move(sources)}, buffer, std::move(dims));
}

OnnxValue OnnxLowering::reshaped(OnnxValue from, OnnxDims dims) {
  GUST_CHECK(elements(dims) == elements(from.dims));
  from.dims = std::move(dims);
  return from;
}

OnnxDims OnnxLowering::broadcast_dims(const OnnxDims& left, const OnnxDims& right) const {
  OnnxDims dims(std::max(left.size(), right.size()));
  const auto size_at = [&](const OnnxDims& of, std::size_t i) {
    const std::size_t missing = dims.size() - of.size();
    return i < missing ? 1 : of[i - missing];
  };
  for (std::size_t i = 0; i < dims.size(); ++i) {
    const std::int64_t a = size_at(left, i);
    const std::int64_t b = size_at(right, i);
    if (a != b && a != 1 && b != 1) fail("combines values of different shapes, or of different lanes of the batch");
    dims[i] = a == 1 ? b : a;
  }
  if (std::count(dims.begin(), dims.end(), kOnnxBatch) > 1) fail("combines values of different lanes of the batch");
  return dims;
}

OnnxValue OnnxLowering::broadcast(const OnnxValue& from, const OnnxDims& dims) {
  if (from.dims == dims) return from;
  const std::size_t size = elements(dims);
  OnnxDims padded(dims.size() - from.dims.size(), 1);
  padded.insert(padded.end(), from.dims.begin(), from.dims.end());
  if (elements(from.dims) == size) return reshaped(from, dims);
  charge(size);
  std::vector<std::size_t> indices(size, 0);
  for (std::size_t i = 0; i < size; ++i) {
    std::size_t rest = i;
    std::size_t stride = 1;
    for (std::size_t axis = dims.size(); axis-- > 0;) {
      const auto whole = static_cast<std::size_t>(std::max<std::int64_t>(dims[axis], 1));
      const auto part = static_cast<std::size_t>(std::max<std::int64_t>(padded[axis], 1));
      indices[i] += rest % whole % part * stride;
      rest /= whole;
      stride *= part;
    }
  }
  OnnxDims target = dims;
  if (from.constant != nullptr) std::replace(target.begin(), target.end(), kOnnxBatch, std::int64_t{1});
  return pick(from, indices, target);
}

OnnxValue OnnxLowering::append(OnnxStep step, std::size_t buffer, OnnxDims dims) {
  program_.steps.push_back(std::move(step));
  return {.dims = std::move(dims), .constant = nullptr, .buffer = buffer};
}

std::size_t OnnxLowering::add_buffer(const OnnxDims& dims) {
  const std::size_t width = elements(dims);
  if (width == 0) fail("makes a value without elements");
  width_ += width;
  if (width_ > kOnnxWidth) {
    fail(cat("brings the values between the nodes above ", kOnnxWidth, " numbers, the limit for a policy"));
  }
  return program_.add_buffer(width);
}

OnnxOperand OnnxLowering::operand(const OnnxValue& value, bool may_be_infinite) const {
  if (value.constant == nullptr) return {.buffer = value.buffer};
  if (!may_be_infinite) check_finite(floats(value));
  return {.buffer = 0, .row = floats(value)};
}

void OnnxLowering::check_finite(std::span<const float> numbers) const {
  const bool finite = std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); });
  if (!finite) fail("has weights that are infinite or not a number; the training that made them has failed");
}

const std::vector<float>& OnnxLowering::floats(const OnnxValue& value) const {
  if (value.constant->integral) fail("computes with integers; only float32 and float64 are supported there");
  return value.constant->floats;
}

void OnnxLowering::charge(std::size_t numbers) {
  numbers_ += numbers;
  if (numbers_ > 2 * kOnnxElements) fail("brings what is computed from the weights beyond the limit for a policy");
}

}  // namespace gust
