#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "gust/onnx/lowering.h"

namespace gust {

/// One operator of ONNX: how many inputs it takes, and its result. `lower` reads the node at hand and sets its
/// outputs; it may take the inputs up to `least_inputs` for present.
struct OnnxOperator {
  std::string_view name;
  std::size_t least_inputs;
  std::size_t most_inputs;
  void (*lower)(OnnxLowering&);
};

inline constexpr std::size_t kAnyInputs = 1024;

/// Operators that combine values number by number, that sum products by an equation, that are functions of one number,
/// that multiply matrices, that take numbers together, that select among them by ranges or by single indices, and that
/// give values another shape.
std::span<const OnnxOperator> onnx_arithmetic_operators();
std::span<const OnnxOperator> onnx_einsum_operators();
std::span<const OnnxOperator> onnx_function_operators();
std::span<const OnnxOperator> onnx_gather_operators();
std::span<const OnnxOperator> onnx_product_operators();
std::span<const OnnxOperator> onnx_reduction_operators();
std::span<const OnnxOperator> onnx_selection_operators();
std::span<const OnnxOperator> onnx_shape_operators();

/// The operator of that name, or nullptr.
const OnnxOperator* find_onnx_operator(std::string_view name);

/// What is wrong with an operator that is not read, and what would be right.
std::string onnx_way_out(std::string_view name);

/// All names, in alphabetical order, with commas.
std::string onnx_operator_names();

}  // namespace gust
