#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

/// action = obs under another shape.
OnnxFixture reshaped(std::initializer_list<std::int64_t> obs_dims, const std::vector<std::int64_t>& shape) {
  OnnxFixture file(obs_dims);
  file.integers("shape", shape);
  file.node("Reshape", {"obs", "shape"}, "action");
  return file;
}

}  // namespace

TEST_CASE("Reshape keeps the batch, however its size is written") {
  const std::vector<float> lane = {1, 2, 3, 4, 5, 6};
  CHECK(act(reshaped({0, 2, 3}, {-1, 6}), lane) == lane);
  CHECK(act(reshaped({0, 2, 3}, {0, -1}), lane) == lane);
  CHECK(act(reshaped({0, 2, 3}, {0, 3, 2}), lane) == lane);
  CHECK(act(reshaped({1, 2, 3}, {1, 6}), lane) == lane);
  CHECK(act(reshaped({1, 2, 3}, {1, -1}), lane) == lane);
  CHECK(act(reshaped({0, 1}, {-1}), {1, 2}) == std::vector<float>{1, 2});
  CHECK(act(reshaped({0, 6}, {1, -1, 6, 1}), lane) == lane);
}

TEST_CASE("Reshape that moves numbers between lanes is refused") {
  CHECK(refusal(reshaped({0, 6}, {-1, 3})).find("cannot give the 6 numbers of a lane") != std::string::npos);
  CHECK(refusal(reshaped({0, 6}, {6, -1})).find("joins the batch") != std::string::npos);
  CHECK(refusal(reshaped({0, 6}, {0, -1, -1})).find("an impossible shape") != std::string::npos);
  CHECK(refusal(reshaped({0, 6}, {-1, -1})).find("two of its sizes are -1") != std::string::npos);
  CHECK(refusal(reshaped({0, 6}, {0, 4, -1})).find("cannot give") != std::string::npos);
  CHECK(refusal(reshaped({0, 6}, {0, 0, 0})).find("does not have") != std::string::npos);
  CHECK(refusal(reshaped({0, 6}, {0, 0, -1, 1, 1, 1, 1, 1, 1})).find("too many dimensions") != std::string::npos);
  CHECK(refusal(reshaped({0, 6}, {0, INT64_MIN})).find("an impossible shape") != std::string::npos);
  CHECK(refusal(reshaped({0, 6}, {0, INT64_MAX})) != "");
}

TEST_CASE("Flatten joins what follows the batch") {
  OnnxFixture file({0, 2, 2});
  file.floats("w", {4, 1}, {1, 10, 100, 1000});
  onnx::NodeProto& node = file.node("Flatten", {"obs"}, "flat");
  file.node("Gemm", {"flat", "w"}, "action");
  CHECK(act(file, {1, 2, 3, 4}) == std::vector<float>{4321});

  set(node, "axis", std::int64_t{2});
  CHECK(refusal(file).find("flattens the batch") != std::string::npos);
}

TEST_CASE("Squeeze and Unsqueeze add and drop sizes of one") {
  OnnxFixture file;
  file.integers("axes", {1, -1});
  file.node("Unsqueeze", {"obs", "axes"}, "wide");
  file.node("Squeeze", {"wide", "axes"}, "narrow");
  file.node("Tanh", {"narrow"}, "action");
  CHECK(act(file, {0, 0, 0}) == std::vector<float>{0, 0, 0});

  OnnxFixture batch;
  batch.integers("axes", {0});
  batch.node("Unsqueeze", {"obs", "axes"}, "action");
  CHECK(act(batch, {1, 2, 3, 4, 5, 6}) == std::vector<float>{1, 2, 3, 4, 5, 6});

  OnnxFixture wide;
  wide.integers("axes", {1});
  wide.node("Squeeze", {"obs", "axes"}, "action");
  CHECK(refusal(wide).find("drops the axis 1, whose size is not 1") != std::string::npos);

  OnnxFixture twice;
  twice.integers("axes", {1, 1});
  twice.node("Unsqueeze", {"obs", "axes"}, "action");
  CHECK(refusal(twice).find("names an axis twice") != std::string::npos);
}

TEST_CASE("a batch of one may be dropped, and every lane still runs by itself") {
  OnnxFixture file({1, 3});
  file.integers("axes", {0});
  file.floats("w", {3}, {1, 10, 100});
  file.node("Squeeze", {"obs", "axes"}, "vector");
  file.node("Mul", {"vector", "w"}, "action");

  CHECK(act(file, {1, 2, 3, 4, 5, 6}) == std::vector<float>{1, 20, 300, 4, 50, 600});
}

TEST_CASE("Cast to float of constants, and of floats to float, is taken") {
  OnnxFixture file;
  file.integers("steps", {1, 2, 3});
  set(file.node("Cast", {"steps"}, "weights"), "to", std::int64_t{11});
  set(file.node("Cast", {"obs"}, "wide"), "to", std::int64_t{11});
  file.node("Mul", {"wide", "weights"}, "action");
  CHECK(act(file, {1, 1, 1}) == std::vector<float>{1, 2, 3});

  OnnxFixture half;
  set(half.node("Cast", {"obs"}, "action"), "to", std::int64_t{10});
  CHECK(refusal(half).find("casts to type 10") != std::string::npos);
}

TEST_CASE("Cast rounds towards 0 and makes truths; integers that depend on the observation are not divided") {
  OnnxFixture file;
  set(file.node("Cast", {"obs"}, "whole"), "to", std::int64_t{7});
  set(file.node("Cast", {"whole"}, "rounded"), "to", std::int64_t{1});
  set(file.node("Cast", {"obs"}, "truth"), "to", std::int64_t{9});
  set(file.node("Cast", {"truth"}, "ones"), "to", std::int64_t{1});
  file.node("Add", {"rounded", "ones"}, "action");
  CHECK(act(file, {-1.75f, 0, 2.5f}) == std::vector<float>{0, 0, 3});

  OnnxFixture divided;
  set(divided.node("Cast", {"obs"}, "whole"), "to", std::int64_t{7});
  divided.integers("two", {2});
  divided.node("Div", {"whole", "two"}, "action");
  CHECK(refusal(divided).find("divides integers") != std::string::npos);
}

TEST_CASE("Constant takes every form of numbers") {
  for (const bool list : {false, true}) {
    OnnxFixture file;
    onnx::AttributeProto& value = *file.node("Constant", {}, "two").add_attribute();
    value.set_name(list ? "value_floats" : "value_float");
    value.set_type(list ? onnx::AttributeProto::FLOATS : onnx::AttributeProto::FLOAT);
    list ? value.add_floats(2.0f) : value.set_f(2.0f);
    file.node("Mul", {"obs", "two"}, "action");
    CHECK(act(file, {1, 2, 3}) == std::vector<float>{2, 4, 6});
  }

  OnnxFixture text;
  onnx::AttributeProto& value = *text.node("Constant", {}, "text").add_attribute();
  value.set_name("value_string");
  value.set_type(onnx::AttributeProto::STRING);
  text.node("Mul", {"obs", "text"}, "action");
  CHECK(refusal(text).find("neither numbers nor integers") != std::string::npos);
}

TEST_CASE("a shape computed from the observation holds for any batch") {
  OnnxFixture file;
  file.node("Shape", {"obs"}, "size");
  file.node("ConstantOfShape", {"size"}, "zeros");
  file.floats("scale", {}, {3});
  file.node("Expand", {"scale", "size"}, "scales");
  file.node("Add", {"zeros", "obs"}, "same");
  file.node("Mul", {"same", "scales"}, "action");

  CHECK(act(file, {1, 2, 3, 4, 5, 6}) == std::vector<float>{3, 6, 9, 12, 15, 18});
}

TEST_CASE("hostile sizes of shapes are refused") {
  OnnxFixture file;
  file.integers("size", {INT64_MAX, INT64_MAX});
  file.node("ConstantOfShape", {"size"}, "zeros");
  file.node("Add", {"zeros", "obs"}, "action");
  CHECK(refusal(file).find("makes a value of the size") != std::string::npos);

  OnnxFixture expand;
  expand.integers("size", {1, 1 << 24, 3});
  expand.node("Expand", {"obs", "size"}, "action");
  CHECK(refusal(expand) != "");

  OnnxFixture dynamic;
  dynamic.node("ConstantOfShape", {"obs"}, "zeros");
  dynamic.node("Add", {"zeros", "obs"}, "action");
  CHECK(refusal(dynamic).find("needs constant integers for 'shape'") != std::string::npos);
}
