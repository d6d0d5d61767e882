#include "gust/onnx/program.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace gust;

namespace {

std::vector<float> mapped(OnnxFunction function, std::vector<float> x, float a = 0.0f, float b = 0.0f) {
  std::vector<float> y(x.size());
  apply({.from = 0, .to = 0, .function = function, .a = a, .b = b}, x, y.data());
  return y;
}

/// Two inputs, W = [[1, 2, 3], [4, 5, 6]], b = (10, 20, 30), then the first minus the third output.
OnnxProgram small_program() {
  OnnxProgram program;
  program.add_buffer(2);
  program.add_buffer(3);
  program.add_buffer(1);
  program.add_buffer(1);
  program.add_buffer(1);
  program.steps.push_back(OnnxDense{
      .from = 0, .to = 1, .rows = 1, .inputs = 2, .outputs = 3, .weights = {1, 2, 3, 4, 5, 6}, .bias = {10, 20, 30}});
  program.steps.push_back(OnnxPick{.to = 2, .sources = {{1, 0}}});
  program.steps.push_back(OnnxPick{.to = 3, .sources = {{1, 2}}});
  program.steps.push_back(
      OnnxCombine{.arithmetic = OnnxArithmetic::kSub, .left = {.buffer = 2}, .right = {.buffer = 3}, .to = 4});
  program.result = 4;
  return program;
}

}  // namespace

TEST_CASE("a program runs its steps for every lane, whatever their number") {
  OnnxProgramRunner runner(small_program());
  const std::vector<float> in = {1, 0, 0, 1, 1, 1, 2, 0, 0, 2, 2, 2, 3, 0, 0, 3, 3, 3};
  std::vector<float> out(9);

  runner.run(in, 9, out);

  CHECK(out == std::vector<float>{-22, -22, -24, -24, -24, -28, -26, -26, -32});

  std::vector<float> last(1);
  runner.run({in.data() + 16, 2}, 1, last);
  CHECK(last[0] == out[8]);
}

TEST_CASE("no lanes are no work") {
  OnnxProgramRunner runner(small_program());

  CHECK_NOTHROW(runner.run({}, 0, {}));
}

TEST_CASE("steps that the result does not need are removed") {
  OnnxProgram program = small_program();
  program.result = 2;

  program.remove_unused();

  CHECK(program.steps.size() == 2);
  OnnxProgramRunner runner(program);
  std::vector<float> out(1);
  runner.run(std::vector<float>{1, 1}, 1, out);
  CHECK(out[0] == 15.0f);
}

TEST_CASE("functions give exact values where these exist") {
  CHECK(mapped(OnnxFunction::kRelu, {-1, 0, 2}) == std::vector<float>{0, 0, 2});
  CHECK(mapped(OnnxFunction::kLeakyRelu, {-1, 2}, 0.25f) == std::vector<float>{-0.25f, 2});
  CHECK(mapped(OnnxFunction::kClip, {-3, 0, 3}, -1, 2) == std::vector<float>{-1, 0, 2});
  CHECK(mapped(OnnxFunction::kSqrt, {4, 0.25f}) == std::vector<float>{2, 0.5f});
  CHECK(mapped(OnnxFunction::kExp, {0, -1000, 1000}) == std::vector<float>{1, 0, INFINITY});
  CHECK(mapped(OnnxFunction::kTanh, {0, 100, -100}) == std::vector<float>{0, 1, -1});
  CHECK(mapped(OnnxFunction::kSigmoid, {0, 1000, -1000}) == std::vector<float>{0.5f, 1, 0});
  CHECK(mapped(OnnxFunction::kSoftplus, {1000, -1000}) == std::vector<float>{1000, 0});
  CHECK(mapped(OnnxFunction::kElu, {-1000, 3}, 0.5f) == std::vector<float>{-0.5f, 3});
}

TEST_CASE("functions are the true value, rounded: within one unit in the last place") {
  for (double x = -20.0; x <= 20.0; x += 0.0371) {
    const auto f = static_cast<float>(x);
    const double exact = f;
    const auto near = [&](OnnxFunction function, double expected) {
      const float got = mapped(function, {f}, 1.0f)[0];
      const auto rounded = static_cast<float>(expected);
      return got == rounded || got == std::nextafter(rounded, INFINITY) || got == std::nextafter(rounded, -INFINITY);
    };
    CHECK(near(OnnxFunction::kTanh, std::tanh(exact)));
    CHECK(near(OnnxFunction::kSigmoid, 1.0 / (1.0 + std::exp(-exact))));
    CHECK(near(OnnxFunction::kSoftplus, std::log1p(std::exp(exact))));
    CHECK(near(OnnxFunction::kExp, std::exp(exact)));
    CHECK(near(OnnxFunction::kElu, x < 0 ? std::expm1(exact) : exact));
  }
}

TEST_CASE("what is not a number stays visible") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto function :
       {OnnxFunction::kTanh, OnnxFunction::kRelu, OnnxFunction::kLeakyRelu, OnnxFunction::kElu, OnnxFunction::kSigmoid,
        OnnxFunction::kSoftplus, OnnxFunction::kExp, OnnxFunction::kClip}) {
    CHECK(std::isnan(mapped(function, {nan}, -1.0f, 1.0f)[0]));
  }
  for (const auto arithmetic : {OnnxArithmetic::kMin, OnnxArithmetic::kMax}) {
    std::vector<float> out(2);
    const float left[] = {nan, 1.0f};
    const float right[] = {1.0f, nan};
    apply(arithmetic, left, right, out);
    CHECK(std::isnan(out[0]));
    CHECK(std::isnan(out[1]));
  }
}
