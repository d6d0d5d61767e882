#include "gust/onnx/functions.h"

#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

#include "gust/core/math.h"

namespace gust {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kRootOfHalf = 0x1.6a09e667f3bcdp-1;

// Floats reach far beyond the range in which exp() is neither zero nor infinite; the bounds keep its integers from
// overflowing.
double exponential(double x) {
  const double above = x < -709.0 ? -709.0 : x;
  return exp(above > 710.0 ? 710.0 : above);
}

/// log() for every number.
double logarithm(double x) {
  if (x > 0.0) return x == kInfinity ? x : log(x);
  return x == 0.0 ? -kInfinity : kNan;
}

double hyperbolic_tangent(double x) {
  const double size = x < 0.0 ? -x : x;
  const double y = 1.0 - 2.0 / (exponential(2.0 * size) + 1.0);
  return x < 0.0 ? -y : y;
}

double softplus(double x) {
  const double tail = exponential(x < 0.0 ? x : -x);
  return (x < 0.0 ? 0.0 : x) + log(1.0 + tail);  // NaN stays NaN
}

double is_infinite(double x, double upward, double downward) {
  return (x == kInfinity && upward != 0.0) || (x == -kInfinity && downward != 0.0) ? 1.0 : 0.0;
}

double tangent(double x) {
  const SinCos<double> at = sin_cos(x);
  return at.sin / at.cos;
}

double sigmoid(double x) { return 1.0 / (1.0 + exponential(-x)); }

/// erfc(x) = t exp(P(2t - 1) - x^2) for x >= 0 with t = 2 / (2 + x), the form of Press et al., Numerical Recipes (3rd
/// ed., 6.2.2). P interpolates at the 20 Chebyshev nodes of -1 ... 1, within 6e-13.
double erfc_above(double x) {
  const double t = 2.0 / (2.0 + x);
  const double power = detail::horner(2.0 * t - 1.0, 2.6403042778749209027e-7, -9.0261535025044813534e-7,
                                      -1.0977145573937414998e-6, 7.2228794910235697779e-6, -1.8816869421910296461e-6,
                                      -2.8381514838741601277e-5, 3.3112385148492503352e-5, 7.004355495978403117e-5,
                                      -1.7488485991715225614e-4, -9.3121182509872779454e-5, 6.7383312494048209932e-4,
                                      -1.4641376988948324938e-4, -2.3458355708820370161e-3, 1.7589594588031757896e-3,
                                      8.824940341344963586e-3, -9.8726913999806709338e-3, -4.6895610284954165237e-2,
                                      4.7343306903682597335e-2, 6.7264322397792535683e-1, -6.7179408405700130881e-1);
  return t * exponential(power - x * x);
}

double error_complement(double x) { return x < 0.0 ? 2.0 - erfc_above(-x) : erfc_above(x); }

/// Near 0, where 1 - erfc would cancel, Kummer's series 2/sqrt(pi) exp(-x^2) sum 2^n x^(2n+1) / (2n+1)!!.
double error_function(double x) {
  if (!(x > -0.5 && x < 0.5)) return 1.0 - error_complement(x);
  double term = x;
  double sum = x;
  for (int n = 1; n <= 12; ++n) sum += term *= 2.0 * x * x / (2 * n + 1);
  return 0x1.20dd750429b6dp+0 * exponential(-x * x) * sum;
}

/// Brought near 0 by 1/x and by halving the angle twice, then the power series.
double arctangent(double x) {
  if (x != x) return x;
  const double size = x < 0.0 ? -x : x;
  double y = size > 1.0 ? 1.0 / size : size;
  for (int half = 0; half < 2; ++half) y = y / (1.0 + std::sqrt(1.0 + y * y));
  double series = 0.0;
  for (int n = 12; n >= 0; --n) series = (n % 2 == 0 ? 1.0 : -1.0) / (2 * n + 1) + y * y * series;
  const double angle = 4.0 * y * series;
  const double whole = size > 1.0 ? 0.5 * kPi - angle : angle;
  return x < 0.0 ? -whole : whole;
}

double arcsine(double x) {
  const double cosine = std::sqrt((1.0 - x) * (1.0 + x));
  if (cosine == 0.0) return x < 0.0 ? -0.5 * kPi : 0.5 * kPi;
  return arctangent(x / cosine);
}

double area_sine(double x) {
  const double size = x < 0.0 ? -x : x;
  const double y = logarithm(size + std::sqrt(size * size + 1.0));
  return x < 0.0 ? -y : y;
}

double clipped(double x, double low, double high) {
  const double above = x < low ? low : x;
  return above > high ? high : above;
}

double shrunk(double x, double lambda, double bias) {
  if (x < -lambda) return x + bias;
  return x > lambda ? x - bias : 0.0;
}

double sign(double x) {
  if (x > 0.0) return 1.0;
  return x < 0.0 ? -1.0 : x;
}

double gelu_tanh(double x) {
  constexpr double kRootOfTwoOverPi = 0x1.9884533d43651p-1;
  return 0.5 * x * (1.0 + hyperbolic_tangent(kRootOfTwoOverPi * (x + 0.044715 * x * x * x)));
}

double celu(double x, double a) { return x < 0.0 ? a * (exponential(x / a) - 1.0) : x; }

double power(double x, double y) {
  if (y == 0.0 || x == 1.0) return 1.0;
  if (x != x || y != y) return kNan;
  const double size = std::fabs(x);
  const bool odd = std::fabs(y) < 0x1p53 && std::fmod(y, 2.0) != 0.0 && std::floor(y) == y;
  if (x < 0.0 && size != kInfinity && std::floor(y) != y) return kNan;
  const double sign = std::signbit(x) && odd ? -1.0 : 1.0;
  if (std::floor(y) == y && std::fabs(y) <= 64.0) {
    double product = 1.0;
    for (int n = 0; n < static_cast<int>(std::fabs(y)); ++n) product *= size;
    return sign * (y < 0.0 ? 1.0 / product : product);
  }
  if (size == 0.0 || size == kInfinity) return sign * ((size == 0.0) == (y > 0.0) ? 0.0 : kInfinity);
  if (size == 1.0) return sign;
  return sign * exponential(y * log(size));
}

using Map = void (*)(OnnxParameters, std::span<const float>, float*);

template <auto f>
void map_all(OnnxParameters parameters, std::span<const float> from, float* to) {
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = static_cast<float>(f(from[i], parameters.a, parameters.b));
}

struct Formula {
  OnnxFunction function;
  Map map;
};
using enum OnnxFunction;

constexpr Formula kFormulas[] = {
    {kTanh, map_all<[](double x, double, double) { return hyperbolic_tangent(x); }>},
    {kRelu, map_all<[](double x, double, double) { return x < 0.0 ? 0.0 : x; }>},
    {kLeakyRelu, map_all<[](double x, double a, double) { return x < 0.0 ? a * x : x; }>},
    {kElu, map_all<[](double x, double a, double) { return x < 0.0 ? a * (exponential(x) - 1.0) : x; }>},
    {kSigmoid, map_all<[](double x, double, double) { return sigmoid(x); }>},
    {kSoftplus, map_all<[](double x, double, double) { return softplus(x); }>},
    {kExp, map_all<[](double x, double, double) { return exponential(x); }>},
    {kSqrt, map_all<[](double x, double, double) { return std::sqrt(x); }>},
    {kClip, map_all<[](double x, double a, double b) { return clipped(x, a, b); }>},
    {kAbs, map_all<[](double x, double, double) { return std::fabs(x); }>},
    {kAcos, map_all<[](double x, double, double) { return 0.5 * kPi - arcsine(x); }>},
    {kAsin, map_all<[](double x, double, double) { return arcsine(x); }>},
    {kAsinh, map_all<[](double x, double, double) { return area_sine(x); }>},
    {kAtan, map_all<[](double x, double, double) { return arctangent(x); }>},
    {kCeil, map_all<[](double x, double, double) { return std::ceil(x); }>},
    {kCelu, map_all<[](double x, double a, double) { return celu(x, a); }>},
    {kCos, map_all<[](double x, double, double) { return sin_cos(x).cos; }>},
    {kCosh, map_all<[](double x, double, double) { return 0.5 * (exponential(x) + exponential(-x)); }>},
    {kErf, map_all<[](double x, double, double) { return error_function(x); }>},
    {kFloor, map_all<[](double x, double, double) { return std::floor(x); }>},
    {kGelu, map_all<[](double x, double, double) { return 0.5 * x * error_complement(-kRootOfHalf * x); }>},
    {kGeluTanh, map_all<[](double x, double, double) { return gelu_tanh(x); }>},
    {kHardSigmoid, map_all<[](double x, double a, double b) { return clipped(a * x + b, 0.0, 1.0); }>},
    {kHardSwish, map_all<[](double x, double, double) { return x * clipped(x / 6.0 + 0.5, 0.0, 1.0); }>},
    {kIsInf, map_all<[](double x, double a, double b) { return is_infinite(x, a, b); }>},
    {kIsNan, map_all<[](double x, double, double) { return x != x ? 1.0 : 0.0; }>},
    {kLog, map_all<[](double x, double, double) { return logarithm(x); }>},
    {kMish, map_all<[](double x, double, double) { return x * hyperbolic_tangent(softplus(x)); }>},
    {kNot, map_all<[](double x, double, double) { return x == 0.0 ? 1.0 : 0.0; }>},
    {kReciprocal, map_all<[](double x, double, double) { return 1.0 / x; }>},
    {kRound, map_all<[](double x, double, double) { return std::nearbyint(x); }>},
    {kSelu, map_all<[](double x, double a, double b) { return b * (x < 0.0 ? a * (exponential(x) - 1.0) : x); }>},
    {kShrink, map_all<shrunk>},
    {kSign, map_all<[](double x, double, double) { return sign(x); }>},
    {kSin, map_all<[](double x, double, double) { return sin_cos(x).sin; }>},
    {kSinh, map_all<[](double x, double, double) { return 0.5 * (exponential(x) - exponential(-x)); }>},
    {kSoftsign, map_all<[](double x, double, double) { return x / (1.0 + std::fabs(x)); }>},
    {kSwish, map_all<[](double x, double a, double) { return x * sigmoid(a * x); }>},
    {kTan, map_all<[](double x, double, double) { return tangent(x); }>},
    {kThresholdedRelu, map_all<[](double x, double a, double) { return a < x || x != x ? x : 0.0; }>},
    {kTruncate, map_all<[](double x, double, double) { return std::trunc(x); }>},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < std::size(kFormulas); ++i) {
    if (kFormulas[i].function != static_cast<OnnxFunction>(i)) return false;
  }
  return std::size(kFormulas) == static_cast<std::size_t>(kTruncate) + 1;
}
static_assert(in_order(), "kFormulas lists the functions in the order of OnnxFunction");

template <class F>
void combine_all(const float* left, const float* right, std::span<float> to, F f) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = static_cast<float>(f(left[i], right[i]));
}

std::int64_t floored_remainder(std::int64_t left, std::int64_t right) {
  const std::int64_t rest = left % right;
  return rest != 0 && (rest < 0) != (right < 0) ? rest + right : rest;
}

}  // namespace

void apply(OnnxFunction function, OnnxParameters parameters, std::span<const float> from, float* to) {
  kFormulas[static_cast<std::size_t>(function)].map(parameters, from, to);
}

void apply(OnnxArithmetic arithmetic, const float* left, const float* right, std::span<float> to) {
  const auto all = [&](auto f) { combine_all(left, right, to, f); };
  switch (arithmetic) {
    case OnnxArithmetic::kAdd:
      return all([](float x, float y) { return x + y; });
    case OnnxArithmetic::kSub:
      return all([](float x, float y) { return x - y; });
    case OnnxArithmetic::kMul:
      return all([](float x, float y) { return x * y; });
    case OnnxArithmetic::kDiv:
      return all([](float x, float y) { return x / y; });
    case OnnxArithmetic::kMin:
      return all([](float x, float y) { return x <= y || x != x ? x : y; });
    case OnnxArithmetic::kMax:
      return all([](float x, float y) { return x >= y || x != x ? x : y; });
    case OnnxArithmetic::kPow:
      return all([](double x, double y) { return power(x, y); });
    case OnnxArithmetic::kRemainder:
      return all([](float x, float y) { return std::fmod(x, y); });
    case OnnxArithmetic::kPRelu:
      return all([](float x, float y) { return x < 0.0f ? x * y : x; });
    case OnnxArithmetic::kGreater:
      return all([](float x, float y) { return x > y; });
    case OnnxArithmetic::kGreaterOrEqual:
      return all([](float x, float y) { return x >= y; });
    case OnnxArithmetic::kEqual:
      return all([](float x, float y) { return x == y; });
    case OnnxArithmetic::kAnd:
      return all([](float x, float y) { return x != 0.0f && y != 0.0f; });
    case OnnxArithmetic::kOr:
      return all([](float x, float y) { return x != 0.0f || y != 0.0f; });
    case OnnxArithmetic::kXor:
      return all([](float x, float y) { return (x != 0.0f) != (y != 0.0f); });
  }
}

bool integer_result(OnnxArithmetic arithmetic, std::int64_t left, std::int64_t right, std::int64_t& result) {
  const bool divides = arithmetic == OnnxArithmetic::kDiv || arithmetic == OnnxArithmetic::kRemainder;
  const bool overflows = left == std::numeric_limits<std::int64_t>::min() && right == -1;
  if (divides && (right == 0 || overflows)) return false;
  const auto is = [&](bool truth) { return result = truth ? 1 : 0, true; };
  switch (arithmetic) {
    case OnnxArithmetic::kAdd:
      return !__builtin_add_overflow(left, right, &result);
    case OnnxArithmetic::kSub:
      return !__builtin_sub_overflow(left, right, &result);
    case OnnxArithmetic::kMul:
      return !__builtin_mul_overflow(left, right, &result);
    case OnnxArithmetic::kDiv:
      return result = left / right, true;
    case OnnxArithmetic::kMin:
      return result = left < right ? left : right, true;
    case OnnxArithmetic::kMax:
      return result = left > right ? left : right, true;
    case OnnxArithmetic::kRemainder:
      return result = floored_remainder(left, right), true;
    case OnnxArithmetic::kGreater:
      return is(left > right);
    case OnnxArithmetic::kGreaterOrEqual:
      return is(left >= right);
    case OnnxArithmetic::kEqual:
      return is(left == right);
    case OnnxArithmetic::kAnd:
      return is(left != 0 && right != 0);
    case OnnxArithmetic::kOr:
      return is(left != 0 || right != 0);
    case OnnxArithmetic::kXor:
      return is((left != 0) != (right != 0));
    default:
      return false;
  }
}

}  // namespace gust
