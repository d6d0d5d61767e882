#include "gust/onnx/operators.h"

#include <algorithm>
#include <vector>

#include "gust/core/text.h"

namespace gust {
namespace {

std::vector<OnnxOperator> all_operators() {
  std::vector<OnnxOperator> all;
  for (const auto operators :
       {onnx_arithmetic_operators(), onnx_einsum_operators(), onnx_function_operators(), onnx_gather_operators(),
        onnx_product_operators(), onnx_reduction_operators(), onnx_selection_operators(), onnx_shape_operators()}) {
    all.insert(all.end(), operators.begin(), operators.end());
  }
  std::sort(all.begin(), all.end(), [](const OnnxOperator& a, const OnnxOperator& b) { return a.name < b.name; });
  return all;
}

}  // namespace

const OnnxOperator* find_onnx_operator(std::string_view name) {
  static const std::vector<OnnxOperator> kAll = all_operators();
  const auto found = std::find_if(kAll.begin(), kAll.end(), [&](const OnnxOperator& op) { return op.name == name; });
  return found == kAll.end() ? nullptr : &*found;
}

std::string onnx_way_out(std::string_view name) {
  const auto holds = [&](std::string_view part) { return name.find(part) != std::string_view::npos; };
  if (name.starts_with("Random") || name == "Bernoulli" || name == "Multinomial") {
    return "samples at random; choose the output of the action without noise (output = \"NAME\", --output NAME)";
  }
  if (holds("Quantize") || holds("QLinear") || holds("QGemm") || name.ends_with("Integer")) {
    return "computes with quantised numbers; export the policy as float32, before it is quantised";
  }
  if (name == "Erfc" || name == "Expm1") {
    return "is an operator of TensorFlow that tf2onnx left as it was, and no ONNX runtime reads it; choose another form"
           " of the activation (keras.activations.gelu with approximate=True, elu in place of celu)";
  }
  return "this operator is not supported; supported are " + onnx_operator_names();
}

std::string onnx_operator_names() {
  std::vector<std::string> names;
  for (const OnnxOperator& op : all_operators()) names.emplace_back(op.name);
  return join(names, ", ");
}

}  // namespace gust
