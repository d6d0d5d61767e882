#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

/// action = sums of products of obs with w of a shape, whose numbers are 1, 2, 3 and so on.
OnnxFixture sums(const std::string& equation, const std::vector<std::int64_t>& shape) {
  OnnxFixture file;
  std::size_t count = 1;
  for (const std::int64_t size : shape) count *= static_cast<std::size_t>(size);
  std::vector<float> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(static_cast<float>(i + 1));
  file.floats("w", shape, numbers);
  onnx::AttributeProto& attribute = *file.node("Einsum", {"obs", "w"}, "action").add_attribute();
  attribute.set_name("equation");
  attribute.set_type(onnx::AttributeProto::STRING);
  attribute.set_s(equation);
  return file;
}

}  // namespace

TEST_CASE("Einsum sums products over the letters that the result has not") {
  CHECK(act(sums("bi,ij->bj", {3, 2}), {1, 10, 100}) == std::vector<float>{531, 642});
  CHECK(act(sums("bi,ji->bj", {2, 3}), {1, 10, 100}) == std::vector<float>{321, 654});
  CHECK(act(sums(" b i , i j ", {3, 2}), {1, 10, 100}) == std::vector<float>{531, 642});
  CHECK(act(sums("bi,i->bi", {3}), {1, 10, 100}) == std::vector<float>{1, 20, 300});
  CHECK(act(sums("bi,i->b", {3}), {1, 10, 100, 0, 0, 1}) == std::vector<float>{321, 3});
  CHECK(act(sums("bi,jk->bj", {2, 2}), {1, 10, 100}) == std::vector<float>{333, 777});
}

TEST_CASE("Einsum refuses equations that mix lanes, take a diagonal or do not fit") {
  CHECK(refusal(sums("bi,bj->ij", {3, 2})).find("different sizes along 'b'") != std::string::npos);
  CHECK(refusal(sums("bi,ij->j", {3, 2})).find("along the batch") != std::string::npos);
  CHECK(refusal(sums("bb,bj->bj", {3, 2})).find("takes a diagonal") != std::string::npos);
  CHECK(refusal(sums("...i,ij->...j", {3, 2})).find("a letter for every axis") != std::string::npos);
  CHECK(refusal(sums("bi,ij->bk", {3, 2})).find("does not fit its inputs") != std::string::npos);
  CHECK(refusal(sums("bi->b", {3, 2})).find("does not fit its inputs") != std::string::npos);
  CHECK(refusal(sums("bi,ij->bj", {2, 3})).find("different sizes along 'i'") != std::string::npos);
}
