#pragma once

#include <cstdint>
#include <span>

namespace gust {

/// Functions of one number x with the parameters a and b. They are those of ONNX's operators of the same name where
/// nothing else is said.
enum class OnnxFunction {
  kTanh,
  kRelu,
  kLeakyRelu,  ///< a: the slope below 0
  kElu,        ///< a
  kSigmoid,
  kSoftplus,
  kExp,
  kSqrt,
  kClip,  ///< a, b: the bounds
  kAbs,
  kAcos,
  kAsin,
  kAsinh,
  kAtan,
  kCeil,
  kCelu,  ///< a
  kCos,
  kCosh,
  kErf,
  kFloor,
  kGelu,
  kGeluTanh,
  kHardSigmoid,  ///< clip(a x + b, 0, 1)
  kHardSwish,
  kIsInf,  ///< 1 where x is +infinity (if a is not 0) or -infinity (if b is not 0)
  kIsNan,
  kLog,
  kMish,
  kNot,  ///< 1 where x is 0
  kReciprocal,
  kRound,   ///< to the nearest integer, halves to the even one
  kSelu,    ///< a: alpha, b: gamma
  kShrink,  ///< a: lambda, b: bias
  kSign,
  kSin,
  kSinh,
  kSoftsign,
  kSwish,  ///< x sigmoid(a x)
  kTan,
  kThresholdedRelu,  ///< x above a, else 0
  kTruncate,         ///< towards 0
};

/// Of two numbers x and y. What is a statement is 1 where it is true, else 0.
enum class OnnxArithmetic {
  kAdd,
  kSub,
  kMul,
  kDiv,
  kMin,
  kMax,
  kPow,
  kRemainder,  ///< C's fmod: of the sign of x
  kPRelu,      ///< x, below 0 times y
  kGreater,
  kGreaterOrEqual,
  kEqual,
  kAnd,
  kOr,
  kXor,
};

enum class OnnxReduction { kSum, kMean, kMin, kMax, kProduct, kSumOfSquares, kSumOfSizes, kLength };

struct OnnxParameters {
  float a = 0.0f;
  float b = 0.0f;
};

/// to[i] = f(from[i]), computed in double and rounded. Equal bits on every machine.
void apply(OnnxFunction function, OnnxParameters parameters, std::span<const float> from, float* to);

/// to[i] = left[i] ∘ right[i], in float32; the power is rounded from double.
void apply(OnnxArithmetic arithmetic, const float* left, const float* right, std::span<float> to);

/// The same for integers, as shapes are computed with. False where there is no result: an overflow, or a division by 0.
bool integer_result(OnnxArithmetic arithmetic, std::int64_t left, std::int64_t right, std::int64_t& result);

}  // namespace gust
