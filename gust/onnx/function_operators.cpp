#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/operators.h"

// Operators that are functions of one number.

namespace gust {
namespace {

template <OnnxFunction function>
void lower_map(OnnxLowering& at) {
  at.set_output(0, at.map(at.input(0), function));
}

/// A function with the parameter 'alpha', which is 1 where the node doesn't say it.
template <OnnxFunction function>
void lower_with_alpha(OnnxLowering& at) {
  at.set_output(0, at.map(at.input(0), function, at.attribute("alpha", 1.0f)));
}

void lower_leaky_relu(OnnxLowering& at) {
  at.set_output(0, at.map(at.input(0), OnnxFunction::kLeakyRelu, at.attribute("alpha", 0.01f)));
}

void lower_celu(OnnxLowering& at) {
  const float alpha = at.attribute("alpha", 1.0f);
  if (alpha == 0.0f) at.fail("divides by its 'alpha', which is 0");
  at.set_output(0, at.map(at.input(0), OnnxFunction::kCelu, alpha));
}

void lower_gelu(OnnxLowering& at) {
  const std::string kind = at.attribute("approximate", std::string("none"));
  if (kind != "none" && kind != "tanh") at.fail("has an approximation other than 'none' and 'tanh'");
  at.set_output(0, at.map(at.input(0), kind == "tanh" ? OnnxFunction::kGeluTanh : OnnxFunction::kGelu));
}

void lower_hard_sigmoid(OnnxLowering& at) {
  const float slope = at.attribute("alpha", 0.2f);
  at.set_output(0, at.map(at.input(0), OnnxFunction::kHardSigmoid, slope, at.attribute("beta", 0.5f)));
}

void lower_is_inf(OnnxLowering& at) {
  const auto detects = [&](const char* name) { return at.attribute(name, std::int64_t{1}) != 0 ? 1.0f : 0.0f; };
  at.set_output(0, at.map(at.input(0), OnnxFunction::kIsInf, detects("detect_positive"), detects("detect_negative")));
}

/// Of truths, which a file may hold as integers.
void lower_not(OnnxLowering& at) { at.set_output(0, at.map(at.as_floats(at.input(0)), OnnxFunction::kNot)); }

/// Standard parameters: onnx.ai/onnx/operators, Selu.
void lower_selu(OnnxLowering& at) {
  const float alpha = at.attribute("alpha", 1.67326319217681884765625f);
  const float gamma = at.attribute("gamma", 1.05070102214813232421875f);
  at.set_output(0, at.map(at.input(0), OnnxFunction::kSelu, alpha, gamma));
}

void lower_shrink(OnnxLowering& at) {
  const float lambda = at.attribute("lambd", 0.5f);
  at.set_output(0, at.map(at.input(0), OnnxFunction::kShrink, lambda, at.attribute("bias", 0.0f)));
}

/// A bound is an input; before opset 11 it was an attribute.
float clip_bound(const OnnxLowering& at, std::size_t index, const char* name, float fallback) {
  if (!at.has_input(index)) return at.attribute(name, fallback);
  const OnnxTensor* bound = at.input(index).constant;
  if (bound == nullptr) at.fail("takes bounds that depend on the observation; they must be constant");
  if (bound->integral) at.fail("takes integers as bounds; they must be float32 or float64");
  if (bound->floats.size() != 1 || std::isnan(bound->floats[0])) at.fail("takes a bound that is not one number");
  return bound->floats[0];
}

void lower_clip(OnnxLowering& at) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float low = clip_bound(at, 1, "min", -kInfinity);
  const float high = clip_bound(at, 2, "max", kInfinity);
  at.set_output(0, at.map(at.input(0), OnnxFunction::kClip, low, high));
}

constexpr OnnxOperator kFunctions[] = {
    {"Abs", 1, 1, lower_map<OnnxFunction::kAbs>},
    {"Acos", 1, 1, lower_map<OnnxFunction::kAcos>},
    {"Asin", 1, 1, lower_map<OnnxFunction::kAsin>},
    {"Asinh", 1, 1, lower_map<OnnxFunction::kAsinh>},
    {"Atan", 1, 1, lower_map<OnnxFunction::kAtan>},
    {"Ceil", 1, 1, lower_map<OnnxFunction::kCeil>},
    {"Celu", 1, 1, lower_celu},
    {"Clip", 1, 3, lower_clip},
    {"Cos", 1, 1, lower_map<OnnxFunction::kCos>},
    {"Cosh", 1, 1, lower_map<OnnxFunction::kCosh>},
    {"Elu", 1, 1, lower_with_alpha<OnnxFunction::kElu>},
    {"Erf", 1, 1, lower_map<OnnxFunction::kErf>},
    {"Exp", 1, 1, lower_map<OnnxFunction::kExp>},
    {"Floor", 1, 1, lower_map<OnnxFunction::kFloor>},
    {"Gelu", 1, 1, lower_gelu},
    {"HardSigmoid", 1, 1, lower_hard_sigmoid},
    {"HardSwish", 1, 1, lower_map<OnnxFunction::kHardSwish>},
    {"IsInf", 1, 1, lower_is_inf},
    {"IsNaN", 1, 1, lower_map<OnnxFunction::kIsNan>},
    {"LeakyRelu", 1, 1, lower_leaky_relu},
    {"Log", 1, 1, lower_map<OnnxFunction::kLog>},
    {"Mish", 1, 1, lower_map<OnnxFunction::kMish>},
    {"Not", 1, 1, lower_not},
    {"Reciprocal", 1, 1, lower_map<OnnxFunction::kReciprocal>},
    {"Relu", 1, 1, lower_map<OnnxFunction::kRelu>},
    {"Round", 1, 1, lower_map<OnnxFunction::kRound>},
    {"Selu", 1, 1, lower_selu},
    {"Shrink", 1, 1, lower_shrink},
    {"Sigmoid", 1, 1, lower_map<OnnxFunction::kSigmoid>},
    {"Sign", 1, 1, lower_map<OnnxFunction::kSign>},
    {"Sin", 1, 1, lower_map<OnnxFunction::kSin>},
    {"Sinh", 1, 1, lower_map<OnnxFunction::kSinh>},
    {"Softplus", 1, 1, lower_map<OnnxFunction::kSoftplus>},
    {"Softsign", 1, 1, lower_map<OnnxFunction::kSoftsign>},
    {"Sqrt", 1, 1, lower_map<OnnxFunction::kSqrt>},
    {"Swish", 1, 1, lower_with_alpha<OnnxFunction::kSwish>},
    {"Tan", 1, 1, lower_map<OnnxFunction::kTan>},
    {"Tanh", 1, 1, lower_map<OnnxFunction::kTanh>},
    {"ThresholdedRelu", 1, 1, lower_with_alpha<OnnxFunction::kThresholdedRelu>},
};

}  // namespace

std::span<const OnnxOperator> onnx_function_operators() { return kFunctions; }

}  // namespace gust
