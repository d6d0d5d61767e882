#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/operators.h"

// Operators that choose single elements by constant indices, and that put numbers beside or among others.

namespace gust {
namespace {

using Positions = std::vector<std::size_t>;

std::size_t size_of(std::int64_t dim) { return static_cast<std::size_t>(lane_size(dim)); }

std::size_t product(const OnnxDims& dims, std::size_t from, std::size_t to) {
  std::size_t count = 1;
  for (std::size_t i = from; i < to; ++i) count *= size_of(dims[i]);
  return count;
}

std::size_t position(const OnnxLowering& at, std::int64_t index, std::int64_t size) {
  if (index < -size || index >= size) at.fail(cat("picks index ", index, " among ", size));
  return static_cast<std::size_t>(index < 0 ? index + size : index);
}

std::size_t lane_axis(const OnnxLowering& at, const OnnxDims& dims, std::size_t axis) {
  if (dims[axis] == kOnnxBatch) at.fail("works along the batch; every lane must stay by itself");
  return axis;
}

/// The last dimension of the indices are positions along the axes that follow the `batch_dims` first ones.
void lower_gather_nd(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::vector<std::int64_t> indices = at.integers(1, "indices");
  const OnnxDims& shape = at.input(1).dims;
  const auto shared = static_cast<std::size_t>(std::max<std::int64_t>(at.attribute("batch_dims", std::int64_t{0}), 0));
  const std::size_t depth = shape.empty() || shape.back() < 1 ? 0 : static_cast<std::size_t>(shape.back());
  if (depth == 0 || shared >= shape.size() || shared + depth > from.dims.size()) {
    at.fail("has indices that do not fit its input");
  }
  for (std::size_t i = 0; i < shared; ++i) {
    if (shape[i] != lane_size(from.dims[i])) at.fail("has indices that do not fit its input");
  }
  for (std::size_t i = shared; i < shared + depth; ++i) lane_axis(at, from.dims, i);
  OnnxDims dims(from.dims.begin(), from.dims.begin() + static_cast<std::ptrdiff_t>(shared));
  dims.insert(dims.end(), shape.begin() + static_cast<std::ptrdiff_t>(shared), shape.end() - 1);
  dims.insert(dims.end(), from.dims.begin() + static_cast<std::ptrdiff_t>(shared + depth), from.dims.end());
  const std::size_t rows = indices.size() / depth / std::max<std::size_t>(product(from.dims, 0, shared), 1);
  const std::size_t run = product(from.dims, shared + depth, from.dims.size());
  at.elements(dims);  // refuses what is too large before it is made
  Positions picked;
  for (std::size_t row = 0; row * depth < indices.size(); ++row) {
    std::size_t start = row / std::max<std::size_t>(rows, 1);
    for (std::size_t i = 0; i < depth; ++i) {
      const std::int64_t size = from.dims[shared + i];
      start = start * size_of(size) + position(at, indices[row * depth + i], size);
    }
    for (std::size_t j = 0; j < run; ++j) picked.push_back(start * run + j);
  }
  at.set_output(0, at.pick(from, picked, dims));
}

/// Where the elements lie that an array of indices along one axis means.
Positions positions_along(const OnnxLowering& at, const OnnxDims& dims, std::size_t axis, std::size_t input) {
  const std::vector<std::int64_t> indices = at.integers(input, "indices");
  const OnnxDims& shape = at.input(input).dims;
  if (shape.size() != dims.size()) at.fail("has indices that do not fit its input");
  Positions positions;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    std::size_t rest = i;
    std::size_t stride = 1;
    std::size_t element = 0;
    for (std::size_t k = dims.size(); k-- > 0;) {
      const std::size_t along = rest % size_of(shape[k]);
      if (k != axis && along >= size_of(dims[k])) at.fail("has indices that do not fit its input");
      element += (k == axis ? position(at, indices[i], dims[k]) : along) * stride;
      rest /= size_of(shape[k]);
      stride *= size_of(dims[k]);
    }
    positions.push_back(element);
  }
  return positions;
}

/// The shape of indices, in which the batch is 1 as in every constant.
OnnxDims with_batch_of(OnnxDims shape, const OnnxDims& dims) {
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (dims[i] == kOnnxBatch) shape[i] = kOnnxBatch;
  }
  return shape;
}

void lower_gather_elements(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  const std::size_t axis = lane_axis(at, from.dims, at.axis(at.attribute("axis", std::int64_t{0}), from.dims.size()));
  const Positions picked = positions_along(at, from.dims, axis, 1);
  at.set_output(0, at.pick(from, picked, with_batch_of(at.input(1).dims, from.dims)));
}

/// Puts numbers in place of some elements.
void lower_scatter_elements(OnnxLowering& at) {
  if (at.attribute("reduction", std::string("none")) != "none") at.fail("has a reduction; only 'none' is supported");
  const auto as_buffer = [&](std::size_t index) {
    const OnnxValue& value = at.input(index);
    return value.constant != nullptr ? at.filled(value) : value;
  };
  const OnnxValue onto = as_buffer(0);
  const OnnxValue updates = as_buffer(2);
  const std::size_t axis = lane_axis(at, onto.dims, at.axis(at.attribute("axis", std::int64_t{0}), onto.dims.size()));
  const Positions replaced = positions_along(at, onto.dims, axis, 1);
  if (replaced.size() != at.elements(updates.dims)) at.fail("has as many indices as it has not updates");
  std::vector<OnnxPick::Source> sources;
  for (std::size_t i = 0; i < at.elements(onto.dims); ++i) sources.push_back({onto.buffer, i});
  for (std::size_t i = 0; i < replaced.size(); ++i) sources[replaced[i]] = {updates.buffer, i};
  at.set_output(0, at.pick_many(std::move(sources), onto.dims));
}

/// scikit-learn's choice among the last dimension.
void lower_array_feature_extractor(OnnxLowering& at) {
  const OnnxValue from = at.input(0);
  if (from.dims.size() != 2) at.fail("takes a matrix");
  lane_axis(at, from.dims, 1);
  const std::vector<std::int64_t> indices = at.integers(1, "indices");
  const OnnxDims dims = {from.dims[0], static_cast<std::int64_t>(indices.size())};
  const std::size_t rows = size_of(from.dims[0]);
  at.elements(dims);
  Positions picked;
  for (std::size_t row = 0; row < rows; ++row) {
    for (const std::int64_t index : indices) {
      picked.push_back(row * size_of(from.dims[1]) + position(at, index, from.dims[1]));
    }
  }
  at.set_output(0, at.pick(from, picked, dims));
}

/// The positions along one axis of a value repeated some times.
void lower_tile(OnnxLowering& at) {
  OnnxValue value = at.input(0);
  std::vector<std::int64_t> repeats = at.integers(1, "repeats");
  if (repeats.size() != value.dims.size()) at.fail("has as many repeats as its input has not dimensions");
  for (std::size_t axis = 0; axis < repeats.size(); ++axis) {
    if (repeats[axis] == 1 || (repeats[axis] == kOnnxBatch && value.constant != nullptr)) continue;
    lane_axis(at, value.dims, axis);
    if (repeats[axis] < 1) at.fail(cat("repeats its input ", repeats[axis], " times"));
    OnnxDims dims = value.dims;
    dims[axis] = static_cast<std::int64_t>(at.elements({dims[axis], repeats[axis]}));
    at.elements(dims);
    const std::size_t outer = product(value.dims, 0, axis);
    const std::size_t run = product(value.dims, axis, value.dims.size());
    Positions picked;
    for (std::size_t i = 0; i < outer; ++i) {
      for (std::size_t j = 0; j < run * static_cast<std::size_t>(repeats[axis]); ++j)
        picked.push_back(i * run + j % run);
    }
    value = at.pick(value, picked, dims);
  }
  at.set_output(0, value);
}

constexpr OnnxOperator kGather[] = {
    {"GatherElements", 2, 2, lower_gather_elements},
    {"GatherND", 2, 2, lower_gather_nd},
    {"ScatterElements", 3, 3, lower_scatter_elements},
    {"Tile", 2, 2, lower_tile},
    {"ai.onnx.ml.ArrayFeatureExtractor", 2, 2, lower_array_feature_extractor},
};

}  // namespace

std::span<const OnnxOperator> onnx_gather_operators() { return kGather; }

}  // namespace gust
