#include "gust/onnx/functions.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

using namespace gust;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float of(OnnxFunction function, float x, OnnxParameters parameters = {}) {
  float result = 0;
  apply(function, parameters, std::span(&x, 1), &result);
  return result;
}

float of(OnnxArithmetic arithmetic, float x, float y) {
  float result = 0;
  apply(arithmetic, &x, &y, std::span(&result, 1));
  return result;
}

struct Known {
  OnnxFunction function;
  double (*truth)(double);
  double low, high;
};

}  // namespace

TEST_CASE("elementary functions are those of the C library, to a rounding of float") {
  const Known all[] = {{OnnxFunction::kErf, std::erf, -6, 6},      {OnnxFunction::kAtan, std::atan, -50, 50},
                       {OnnxFunction::kAsin, std::asin, -1, 1},    {OnnxFunction::kAcos, std::acos, -1, 1},
                       {OnnxFunction::kSin, std::sin, -300, 300},  {OnnxFunction::kCos, std::cos, -300, 300},
                       {OnnxFunction::kTan, std::tan, -1.5, 1.5},  {OnnxFunction::kLog, std::log, 1e-30, 1e6},
                       {OnnxFunction::kSinh, std::sinh, -20, 20},  {OnnxFunction::kCosh, std::cosh, -20, 20},
                       {OnnxFunction::kAsinh, std::asinh, -99, 99}};
  for (const Known& known : all) {
    for (int i = 0; i <= 4000; ++i) {
      const auto x = static_cast<float>(known.low + (known.high - known.low) * i / 4000);
      const double truth = known.truth(double{x});
      // Half a unit in the last place of float, and what double is off near 0.
      CHECK(std::fabs(of(known.function, x) - truth) <= 0x1.001p-24 * std::fabs(truth) + 1e-15);
    }
  }
}

TEST_CASE("GELU keeps its digits where it is small") {
  for (const float x : {-8.0f, -5.0f, -1.0f, -1e-3f, 0.0f, 1e-3f, 1.0f, 8.0f}) {
    const double truth = 0.5 * double{x} * std::erfc(-double{x} / std::sqrt(2.0));
    CHECK(std::fabs(of(OnnxFunction::kGelu, x) - truth) <= 1e-7 * std::fabs(truth));
  }
}

TEST_CASE("functions have the limits that C asks for") {
  CHECK(of(OnnxFunction::kLog, 0.0f) == -kInfinity);
  CHECK(std::isnan(of(OnnxFunction::kLog, -1.0f)));
  CHECK(of(OnnxFunction::kLog, kInfinity) == kInfinity);
  CHECK(of(OnnxFunction::kErf, kInfinity) == 1.0f);
  CHECK(of(OnnxFunction::kErf, -kInfinity) == -1.0f);
  CHECK(std::isnan(of(OnnxFunction::kErf, NAN)));
  CHECK(of(OnnxFunction::kAtan, -kInfinity) == static_cast<float>(-std::acos(0.0)));
  CHECK(std::isnan(of(OnnxFunction::kAsin, 1.5f)));
  CHECK(of(OnnxFunction::kRound, 2.5f) == 2.0f);
  CHECK(of(OnnxFunction::kIsNan, NAN) == 1.0f);
  CHECK(of(OnnxFunction::kIsInf, -kInfinity, {1.0f, 0.0f}) == 0.0f);
  CHECK(std::isnan(of(OnnxFunction::kMish, NAN)));
}

TEST_CASE("powers are those of the C library") {
  const std::array<float, 13> numbers = {-kInfinity, -70.0f, -3.0f, -2.5f, -1.0f, -0.0f,    0.0f,
                                         0.5f,       1.0f,   2.0f,  3.5f,  71.0f, kInfinity};
  for (const float x : numbers) {
    for (const float y : numbers) {
      const auto truth = static_cast<float>(std::pow(double{x}, double{y}));
      const float ours = of(OnnxArithmetic::kPow, x, y);
      CAPTURE(x);
      CAPTURE(y);
      if (std::isfinite(truth)) CHECK(std::fabs(ours - truth) <= 0x1p-23f * std::fabs(truth));
      if (!std::isfinite(truth)) CHECK((ours == truth || (std::isnan(ours) && std::isnan(truth))));
    }
  }
}

TEST_CASE("integers that have no result say so") {
  std::int64_t result = 0;
  CHECK(integer_result(OnnxArithmetic::kDiv, 7, -2, result));
  CHECK(result == -3);
  CHECK(integer_result(OnnxArithmetic::kRemainder, -7, 3, result));
  CHECK(result == 2);
  CHECK_FALSE(integer_result(OnnxArithmetic::kDiv, 1, 0, result));
  CHECK_FALSE(integer_result(OnnxArithmetic::kDiv, std::numeric_limits<std::int64_t>::min(), -1, result));
  CHECK_FALSE(integer_result(OnnxArithmetic::kMul, std::int64_t{1} << 62, 4, result));
}
