#include <cstdint>
#include <utility>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/operators.h"

// Operators that combine values number by number. Truths are 1 and 0.

namespace gust {
namespace {

template <OnnxArithmetic arithmetic>
void lower_combine(OnnxLowering& at) {
  at.set_output(0, at.combine(arithmetic, at.input(0), at.input(1)));
}

/// x < y is y > x.
template <OnnxArithmetic arithmetic>
void lower_swapped(OnnxLowering& at) {
  at.set_output(0, at.combine(arithmetic, at.input(1), at.input(0)));
}

/// Any number of inputs, one after another.
template <OnnxArithmetic arithmetic>
OnnxValue combined(OnnxLowering& at) {
  OnnxValue result = at.input(0);
  for (std::size_t i = 1; i < at.inputs(); ++i) result = at.combine(arithmetic, result, at.input(i));
  return result;
}

template <OnnxArithmetic arithmetic>
void lower_list(OnnxLowering& at) {
  at.set_output(0, combined<arithmetic>(at));
}

void lower_mean(OnnxLowering& at) {
  const OnnxValue count = at.number(static_cast<float>(at.inputs()));
  at.set_output(0, at.combine(OnnxArithmetic::kDiv, combined<OnnxArithmetic::kAdd>(at), count));
}

void lower_neg(OnnxLowering& at) {
  const OnnxValue& from = at.input(0);
  const bool integral = from.constant != nullptr && from.integral();
  const OnnxValue factor =
      integral ? at.constant({.dims = {}, .floats = {}, .integers = {-1}, .integral = true}) : at.number(-1.0f);
  at.set_output(0, at.combine(OnnxArithmetic::kMul, from, factor));
}

/// Of floats the remainder has the sign of the first number, as fmod asks; of integers, which only sizes are, that of
/// the second.
void lower_mod(OnnxLowering& at) {
  const bool integral = at.input(0).integral() || at.input(1).integral();
  if (!integral && at.attribute("fmod", std::int64_t{0}) == 0) at.fail("takes floats; 'fmod' must be 1 for them");
  if (integral && (at.input(0).constant == nullptr || at.input(1).constant == nullptr)) {
    at.fail("takes integers that depend on the observation; cast them to float32 first");
  }
  at.set_output(0, at.combine(OnnxArithmetic::kRemainder, at.input(0), at.input(1)));
}

void lower_where(OnnxLowering& at) { at.set_output(0, at.choose(at.input(0), at.input(1), at.input(2))); }

/// scikit-learn's scaling of its inputs: (x - offset) scale, with both as attributes.
void lower_scaler(OnnxLowering& at) {
  OnnxValue value = at.input(0);
  const auto apply = [&](const char* name, OnnxArithmetic arithmetic) {
    const auto numbers = at.attribute(name, std::vector<float>{});
    if (numbers.empty()) return;
    const OnnxDims row = {static_cast<std::int64_t>(numbers.size())};
    value = at.combine(arithmetic, value, at.constant({.dims = row, .floats = numbers, .integers = {}}));
  };
  apply("offset", OnnxArithmetic::kSub);
  apply("scale", OnnxArithmetic::kMul);
  at.set_output(0, value);
}

constexpr OnnxOperator kArithmetic[] = {
    {"Add", 2, 2, lower_combine<OnnxArithmetic::kAdd>},
    {"And", 2, 2, lower_combine<OnnxArithmetic::kAnd>},
    {"Div", 2, 2, lower_combine<OnnxArithmetic::kDiv>},
    {"Equal", 2, 2, lower_combine<OnnxArithmetic::kEqual>},
    {"Greater", 2, 2, lower_combine<OnnxArithmetic::kGreater>},
    {"GreaterOrEqual", 2, 2, lower_combine<OnnxArithmetic::kGreaterOrEqual>},
    {"Less", 2, 2, lower_swapped<OnnxArithmetic::kGreater>},
    {"LessOrEqual", 2, 2, lower_swapped<OnnxArithmetic::kGreaterOrEqual>},
    {"Max", 1, kAnyInputs, lower_list<OnnxArithmetic::kMax>},
    {"Mean", 1, kAnyInputs, lower_mean},
    {"Min", 1, kAnyInputs, lower_list<OnnxArithmetic::kMin>},
    {"Mod", 2, 2, lower_mod},
    {"Mul", 2, 2, lower_combine<OnnxArithmetic::kMul>},
    {"Neg", 1, 1, lower_neg},
    {"Or", 2, 2, lower_combine<OnnxArithmetic::kOr>},
    {"PRelu", 2, 2, lower_combine<OnnxArithmetic::kPRelu>},
    {"Pow", 2, 2, lower_combine<OnnxArithmetic::kPow>},
    {"Sub", 2, 2, lower_combine<OnnxArithmetic::kSub>},
    {"Sum", 1, kAnyInputs, lower_list<OnnxArithmetic::kAdd>},
    {"Where", 3, 3, lower_where},
    {"Xor", 2, 2, lower_combine<OnnxArithmetic::kXor>},
    {"ai.onnx.ml.Scaler", 1, 1, lower_scaler},
};

}  // namespace

std::span<const OnnxOperator> onnx_arithmetic_operators() { return kArithmetic; }

}  // namespace gust
