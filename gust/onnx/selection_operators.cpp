#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/operators.h"

// Operators that choose and reorder numbers along an axis. None may touch the batch: every lane stays by itself.

namespace gust {
namespace {

using Positions = std::vector<std::size_t>;

std::size_t size_of(std::int64_t dim) { return static_cast<std::size_t>(lane_size(dim)); }

std::size_t product(OnnxDims::const_iterator from, OnnxDims::const_iterator to) {
  return std::accumulate(from, to, std::size_t{1}, [](std::size_t a, std::int64_t dim) { return a * size_of(dim); });
}

std::size_t lane_axis(const OnnxLowering& at, const OnnxDims& dims, std::int64_t index) {
  const std::size_t axis = at.axis(index, dims.size());
  if (dims[axis] == kOnnxBatch) at.fail("works along the batch; every lane must stay by itself");
  return axis;
}

/// Where the elements of a value lie whose positions along an axis are picked.
Positions along_axis(const OnnxDims& dims, std::size_t axis, const Positions& picked) {
  const auto at_axis = dims.begin() + static_cast<std::ptrdiff_t>(axis);
  const std::size_t outer = product(dims.begin(), at_axis);
  const std::size_t inner = product(at_axis + 1, dims.end());
  Positions indices;
  for (std::size_t i = 0; i < outer; ++i) {
    for (const std::size_t position : picked) {
      for (std::size_t j = 0; j < inner; ++j) indices.push_back((i * size_of(*at_axis) + position) * inner + j);
    }
  }
  return indices;
}

OnnxValue take(OnnxLowering& at, const OnnxValue& from, std::size_t axis, const Positions& picked) {
  OnnxDims dims = from.dims;
  dims[axis] = static_cast<std::int64_t>(picked.size());
  at.elements(dims);  // refuses what is too large before it is made
  return at.pick(from, along_axis(from.dims, axis, picked), dims);
}

struct Range {
  std::int64_t start;
  std::int64_t end;
  std::int64_t step;
};

/// The positions of a slice of `size` elements; out of range ends are clamped.
Positions slice_positions(const OnnxLowering& at, Range range, std::int64_t size) {
  if (range.step == 0) at.fail("has a step of 0");
  const bool forward = range.step > 0;
  const std::int64_t lowest = forward ? 0 : -1;
  const std::int64_t highest = forward ? size : size - 1;
  const auto bound = [&](std::int64_t index) { return std::clamp(index < 0 ? index + size : index, lowest, highest); };
  const std::int64_t step = std::clamp(range.step, -size - 1, size + 1);
  const std::int64_t end = bound(range.end);
  Positions positions;
  for (std::int64_t i = forward ? bound(range.start) : std::max<std::int64_t>(bound(range.start), -1);
       forward ? i < end : i > end; i += step) {
    positions.push_back(static_cast<std::size_t>(i));
  }
  return positions;
}

void lower_slice(OnnxLowering& at) {
  OnnxValue value = at.input(0);
  const std::vector<std::int64_t> starts = at.integers(1, "starts");
  const std::vector<std::int64_t> ends = at.integers(2, "ends");
  std::vector<std::int64_t> axes = at.integers(3, "axes");
  if (axes.empty()) axes.resize(starts.size());
  if (!at.has_input(3) && at.find_attribute("axes") == nullptr) std::iota(axes.begin(), axes.end(), 0);
  std::vector<std::int64_t> steps(starts.size(), 1);
  if (at.has_input(4)) steps = at.integers(4, "steps");
  if (ends.size() != starts.size() || axes.size() != starts.size() || steps.size() != starts.size()) {
    at.fail("has lists of starts, ends, axes and steps of different lengths");
  }
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const bool is_whole = starts[i] == 0 && ends[i] >= std::numeric_limits<std::int32_t>::max() && steps[i] == 1;
    if (is_whole) continue;  // x[:], also along the batch
    const std::size_t axis = lane_axis(at, value.dims, axes[i]);
    const Positions positions = slice_positions(at, {starts[i], ends[i], steps[i]}, value.dims[axis]);
    value = take(at, value, axis, positions);
  }
  at.set_output(0, value);
}

/// The sizes of the parts: given as an input or an attribute, else as equal as they can be.
std::vector<std::int64_t> split_sizes(const OnnxLowering& at, std::int64_t size) {
  std::vector<std::int64_t> sizes = at.integers(1, "split");
  const auto parts = static_cast<std::int64_t>(at.outputs());
  if (sizes.empty()) {
    const std::int64_t part = (size + parts - 1) / parts;
    sizes.assign(at.outputs(), part);
    sizes.back() = size - part * (parts - 1);
  }
  const bool positive = std::all_of(sizes.begin(), sizes.end(), [&](auto part) { return part >= 0 && part <= size; });
  if (sizes.size() != at.outputs() || !positive ||
      std::accumulate(sizes.begin(), sizes.end(), std::int64_t{0}) != size) {
    at.fail(cat("splits ", size, " into parts that do not add up to it"));
  }
  return sizes;
}

void lower_split(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::size_t axis = lane_axis(at, from.dims, at.attribute("axis", std::int64_t{0}));
  const std::vector<std::int64_t> sizes = split_sizes(at, from.dims[axis]);
  std::size_t start = 0;
  for (std::size_t part = 0; part < sizes.size(); ++part) {
    Positions positions(static_cast<std::size_t>(sizes[part]));
    std::iota(positions.begin(), positions.end(), start);
    start += positions.size();
    at.set_output(part, take(at, from, axis, positions));
  }
}

void lower_gather(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::size_t axis = lane_axis(at, from.dims, at.attribute("axis", std::int64_t{0}));
  Positions positions;
  const std::int64_t size = from.dims[axis];
  for (const std::int64_t index : at.integers(1, "indices")) {
    if (index < -size || index >= size) at.fail(cat("picks index ", index, " among ", size));
    positions.push_back(static_cast<std::size_t>(index < 0 ? index + size : index));
  }
  OnnxValue taken = take(at, from, axis, positions);
  OnnxDims dims = from.dims;
  const auto place = dims.erase(dims.begin() + static_cast<std::ptrdiff_t>(axis));
  dims.insert(place, at.input(1).dims.begin(), at.input(1).dims.end());
  at.set_output(0, at.reshaped(std::move(taken), dims));
}

/// What Concat joins: its inputs, and where each element of the result comes from.
struct Joined {
  std::vector<const OnnxValue*> parts;
  OnnxDims dims;
  std::size_t axis = 0;
  bool constant = true;
};

/// Whether a part has the sizes of the others beside the axis; a constant is the same for every lane of a batch.
bool fits(const OnnxValue& part, const OnnxDims& dims, std::size_t axis) {
  if (part.dims.size() != dims.size()) return false;
  for (std::size_t i = 0; i < dims.size(); ++i) {
    const bool repeated = part.constant != nullptr && part.dims[i] == 1 && dims[i] == kOnnxBatch;
    if (i != axis && part.dims[i] != dims[i] && !repeated) return false;
  }
  return true;
}

Joined read_parts(const OnnxLowering& at) {
  Joined joined;
  for (std::size_t i = 0; i < at.inputs(); ++i) {
    joined.parts.push_back(&at.input(i));
    const bool first_of_lane = joined.constant && at.input(i).constant == nullptr;
    if (i == 0 || first_of_lane) joined.dims = at.input(i).dims;
    joined.constant = joined.constant && at.input(i).constant != nullptr;
  }
  joined.axis = lane_axis(at, joined.dims, at.attribute("axis", std::int64_t{0}));
  std::int64_t size = 0;
  for (const OnnxValue* part : joined.parts) {
    if (!fits(*part, joined.dims, joined.axis)) at.fail("joins values of different shapes");
    if (part->integral() != joined.parts[0]->integral()) at.fail("joins integers with floats");
    size += part->dims[joined.axis];
  }
  joined.dims[joined.axis] = size;
  at.elements(joined.dims);
  return joined;
}

/// Calls take(part, element) for every element of the result, in its order.
template <class F>
void for_each_element(const Joined& joined, F take) {
  const auto axis = joined.dims.begin() + static_cast<std::ptrdiff_t>(joined.axis);
  const std::size_t outer = product(joined.dims.begin(), axis);
  const std::size_t inner = product(axis + 1, joined.dims.end());
  for (std::size_t i = 0; i < outer; ++i) {
    for (const OnnxValue* part : joined.parts) {
      const std::size_t run = size_of(part->dims[joined.axis]) * inner;
      for (std::size_t j = i * run; j < (i + 1) * run; ++j) take(*part, j);
    }
  }
}

OnnxValue joined_constant(OnnxLowering& at, const Joined& joined) {
  OnnxTensor tensor{.dims = joined.dims, .floats = {}, .integers = {}, .integral = joined.parts[0]->integral()};
  for_each_element(joined, [&](const OnnxValue& part, std::size_t element) {
    if (tensor.integral) {
      tensor.integers.push_back(part.constant->integers[element]);
    } else {
      tensor.floats.push_back(part.constant->floats[element]);
    }
  });
  return at.constant(std::move(tensor));
}

void lower_concat(OnnxLowering& at) {
  Joined joined = read_parts(at);
  if (joined.constant) return at.set_output(0, joined_constant(at, joined));
  std::deque<OnnxValue> filled;  // the constants among the parts, as values of a lane
  for (const OnnxValue*& part : joined.parts) {
    if (part->constant != nullptr) part = &filled.emplace_back(at.filled(*part));
  }
  std::vector<OnnxPick::Source> sources;
  for_each_element(joined, [&](const OnnxValue& part, std::size_t element) {
    sources.push_back({part.buffer, element});
  });
  OnnxValue result = at.pick_many(std::move(sources), joined.dims);
  result.whole = joined.parts[0]->whole;
  result.truth = joined.parts[0]->truth;
  at.set_output(0, result);
}

std::vector<std::int64_t> permutation(const OnnxLowering& at, std::size_t rank) {
  std::vector<std::int64_t> natural(rank);
  std::iota(natural.begin(), natural.end(), 0);
  const std::vector<std::int64_t> order =
      at.attribute("perm", std::vector<std::int64_t>(natural.rbegin(), natural.rend()));
  if (!std::is_permutation(order.begin(), order.end(), natural.begin(), natural.end())) {
    at.fail("has a 'perm' that is no permutation of the axes");
  }
  return order;
}

void lower_transpose(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::vector<std::int64_t> order = permutation(at, from.dims.size());
  at.set_output(0, at.transposed(from, {order.begin(), order.end()}));
}

constexpr OnnxOperator kSelection[] = {
    {"Concat", 1, kAnyInputs, lower_concat},
    {"Gather", 2, 2, lower_gather},
    {"Slice", 1, 5, lower_slice},
    {"Split", 1, 2, lower_split},
    {"Transpose", 1, 1, lower_transpose},
};

}  // namespace

std::span<const OnnxOperator> onnx_selection_operators() { return kSelection; }

}  // namespace gust
