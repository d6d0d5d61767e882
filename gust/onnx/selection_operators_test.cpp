#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

OnnxFixture sliced(std::int64_t start, std::int64_t end, std::int64_t step) {
  OnnxFixture file({0, 5});
  file.integers("start", {start});
  file.integers("end", {end});
  file.integers("axes", {1});
  file.integers("step", {step});
  file.node("Slice", {"obs", "start", "end", "axes", "step"}, "action");
  return file;
}

}  // namespace

TEST_CASE("Slice cuts out a range, clamped, forwards or backwards") {
  const std::vector<float> lane = {0, 1, 2, 3, 4};
  CHECK(act(sliced(1, 3, 1), lane) == std::vector<float>{1, 2});
  CHECK(act(sliced(-2, INT64_MAX, 1), lane) == std::vector<float>{3, 4});
  CHECK(act(sliced(0, 5, 2), lane) == std::vector<float>{0, 2, 4});
  CHECK(act(sliced(-1, INT64_MIN, -1), lane) == std::vector<float>{4, 3, 2, 1, 0});
  CHECK(act(sliced(INT64_MAX, 0, -3), lane) == std::vector<float>{4, 1});
  CHECK(act(sliced(INT64_MIN, INT64_MAX, INT64_MAX), lane) == std::vector<float>{0});
  CHECK(act(sliced(4, INT64_MIN, INT64_MIN), lane) == std::vector<float>{4});
}

TEST_CASE("Slice of nothing, without a step or along the batch is refused") {
  CHECK(refusal(sliced(3, 3, 1)).find("without elements") != std::string::npos);
  CHECK(refusal(sliced(0, 5, 0)).find("a step of 0") != std::string::npos);

  OnnxFixture file({0, 5});
  file.integers("start", {0});
  file.integers("end", {1});
  file.node("Slice", {"obs", "start", "end"}, "action");
  CHECK(refusal(file).find("works along the batch") != std::string::npos);

  OnnxFixture lists({0, 5});
  lists.integers("start", {0});
  lists.integers("end", {1, 2});
  lists.integers("axes", {1});
  lists.node("Slice", {"obs", "start", "end", "axes"}, "action");
  CHECK(refusal(lists).find("different lengths") != std::string::npos);
}

TEST_CASE("Split and Concat take lanes apart and together") {
  OnnxFixture file({0, 5});
  file.integers("sizes", {2, 3});
  onnx::NodeProto& split = file.node("Split", {"obs", "sizes"}, "head");
  split.add_output("tail");
  set(split, "axis", std::int64_t{1});
  set(file.node("Concat", {"tail", "head", "tail"}, "action"), "axis", std::int64_t{-1});
  CHECK(act(file, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}) ==
        std::vector<float>{2, 3, 4, 0, 1, 2, 3, 4, 7, 8, 9, 5, 6, 7, 8, 9});

  file.graph().mutable_initializer(0)->set_int64_data(1, 4);
  CHECK(refusal(file).find("parts that do not add up") != std::string::npos);

  split.mutable_input()->RemoveLast();
  CHECK(act(file, {0, 1, 2, 3, 4}) == std::vector<float>{3, 4, 0, 1, 2, 3, 4});
}

TEST_CASE("Concat joins constants to the observation, the same in every lane") {
  OnnxFixture file({0, 2});
  file.floats("goal", {1, 2}, {7, 8});
  set(file.node("Concat", {"goal", "obs"}, "action"), "axis", std::int64_t{1});
  CHECK(act(file, {1, 2, 3, 4}) == std::vector<float>{7, 8, 1, 2, 7, 8, 3, 4});

  OnnxFixture rows({0, 2});
  rows.floats("goal", {2, 2}, {7, 8, 7, 8});
  set(rows.node("Concat", {"obs", "goal"}, "action"), "axis", std::int64_t{1});
  CHECK(refusal(rows).find("different shapes") != std::string::npos);

  OnnxFixture whole({0, 2});
  whole.integers("goal", {7}).add_dims(1);
  set(whole.node("Concat", {"obs", "goal"}, "action"), "axis", std::int64_t{1});
  CHECK(refusal(whole).find("integers with floats") != std::string::npos);
}

TEST_CASE("Slice takes the whole batch, and before opset 10 its ranges as attributes") {
  OnnxFixture file;
  file.integers("start", {0, 1});
  file.integers("end", {2147483647, 3});
  file.node("Slice", {"obs", "start", "end"}, "action");
  CHECK(act(file, {1, 2, 3, 4, 5, 6}) == std::vector<float>{2, 3, 5, 6});

  OnnxFixture old;
  old.model.mutable_opset_import(0)->set_version(9);
  onnx::NodeProto& node = old.node("Slice", {"obs"}, "action");
  set_list(node, "starts", {1});
  set_list(node, "ends", {3});
  set_list(node, "axes", {1});
  CHECK(act(old, {1, 2, 3, 4, 5, 6}) == std::vector<float>{2, 3, 5, 6});
}

TEST_CASE("Gather picks by index, and drops the axis for a single one") {
  OnnxFixture file({0, 5});
  file.integers("indices", {4, -5, 2});
  set(file.node("Gather", {"obs", "indices"}, "action"), "axis", std::int64_t{1});
  CHECK(act(file, {0, 1, 2, 3, 4}) == std::vector<float>{4, 0, 2});

  file.graph().mutable_initializer(0)->set_int64_data(0, 5);
  CHECK(refusal(file).find("picks index 5 among 5") != std::string::npos);

  OnnxFixture single({0, 2, 2});
  single.integers("index", {1}).clear_dims();
  set(single.node("Gather", {"obs", "index"}, "row"), "axis", std::int64_t{1});
  single.floats("w", {2, 1}, {1, 10});
  single.node("Gemm", {"row", "w"}, "action");
  CHECK(act(single, {1, 2, 3, 4}) == std::vector<float>{43});
}

TEST_CASE("Transpose reorders what follows the batch") {
  OnnxFixture file({0, 2, 3});
  onnx::AttributeProto& order = *file.node("Transpose", {"obs"}, "action").add_attribute();
  order.set_name("perm");
  order.set_type(onnx::AttributeProto::INTS);
  for (const std::int64_t axis : {0, 2, 1}) order.add_ints(axis);
  CHECK(act(file, {0, 1, 2, 3, 4, 5}) == std::vector<float>{0, 3, 1, 4, 2, 5});

  order.set_ints(0, 1);
  CHECK(refusal(file).find("no permutation") != std::string::npos);

  order.set_ints(1, 2);
  order.set_ints(2, 0);
  file.node("Flatten", {"action"}, "flat");
  file.graph().mutable_output(0)->set_name("flat");
  CHECK(refusal(file).find("first dimension is not the batch") != std::string::npos);
}
