#include "gust/onnx/proto.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "gust/core/error.h"

using namespace gust;

namespace {

std::string parse_error(const std::string& bytes) {
  try {
    parse_onnx(bytes, "x.onnx");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string tensor_error(const onnx::TensorProto& proto) {
  try {
    read_onnx_tensor(proto, "x.onnx: tensor 'w'");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

onnx::TensorProto tensor(onnx::TensorProto::DataType type, const std::vector<std::int64_t>& dims) {
  onnx::TensorProto proto;
  proto.set_data_type(type);
  for (const std::int64_t dim : dims) proto.add_dims(dim);
  return proto;
}

/// A field of length-delimited type.
std::string field(int number, const std::string& content) {
  std::string bytes(1, static_cast<char>(number << 3 | 2));
  for (std::size_t size = content.size(); true; size >>= 7) {
    bytes += static_cast<char>(size > 127 ? (size & 127) | 128 : size);
    if (size <= 127) return bytes + content;
  }
}

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

}  // namespace

TEST_CASE("bytes that are no ONNX message are refused by their name") {
  CHECK(parse_error("") == "x.onnx: is empty; expected an ONNX file");
  CHECK(parse_error("#!/bin/sh\necho hello\n") == "x.onnx: is not an ONNX file, or it is damaged or cut short");
  CHECK(parse_error(std::string(kOnnxBytes + 1, 'x')).find("limit") != std::string::npos);
}

TEST_CASE("a small file that would fill the memory with empty messages is refused") {
  // Two bytes of an empty message become hundreds in memory: nodes, attributes, graphs in graphs, dimensions,
  // functions.
  const std::string node = field(1, "");
  const std::string attribute = field(5, "");
  const std::string many_nodes = repeated(node, kOnnxFields);
  const std::string many_attributes = repeated(attribute, kOnnxFields);
  const std::string dims = repeated(field(1, ""), kOnnxFields);

  CHECK(parse_error(field(7, many_nodes)).find("no policy network") != std::string::npos);
  CHECK(parse_error(field(7, field(1, many_attributes))).find("no policy network") != std::string::npos);
  CHECK(parse_error(field(7, field(1, field(5, field(6, many_nodes))))).find("no policy network") != std::string::npos);
  CHECK(parse_error(field(7, field(11, field(2, field(1, field(2, dims)))))).find("no policy network") !=
        std::string::npos);
  CHECK(parse_error(repeated("\xca\x01" + std::string(1, '\0'), kOnnxFields + 1)).find("no policy network") !=
        std::string::npos);
}

TEST_CASE("packed integers count one by one, floats do not") {
  const std::string integers(kOnnxFields, '\1');
  const std::string floats(4 * kOnnxFields, '\0');

  CHECK(parse_error(field(7, field(5, field(7, integers)))).find("no policy network") != std::string::npos);
  CHECK(parse_error(field(7, field(5, field(4, floats)))) == "");
}

TEST_CASE("a file nested without end is refused") {
  std::string graph;
  for (int i = 0; i < 200; ++i) graph = field(1, field(5, field(6, graph)));

  CHECK(parse_error(field(7, graph)) != "");
}

TEST_CASE("a tensor may hold raw bytes or typed numbers") {
  onnx::TensorProto typed = tensor(onnx::TensorProto::FLOAT, {2, 1});
  typed.add_float_data(0.5f);
  typed.add_float_data(-3.0f);
  onnx::TensorProto raw = tensor(onnx::TensorProto::FLOAT, {2, 1});
  const float numbers[] = {0.5f, -3.0f};
  raw.set_raw_data(numbers, sizeof numbers);

  for (const auto& proto : {typed, raw}) {
    const OnnxTensor read = read_onnx_tensor(proto, "w");
    CHECK(read.dims == OnnxDims{2, 1});
    CHECK(read.floats == std::vector{0.5f, -3.0f});
    CHECK_FALSE(read.integral);
  }
}

TEST_CASE("float64 is rounded, and integers and truths stay integers") {
  onnx::TensorProto wide = tensor(onnx::TensorProto::DOUBLE, {});
  wide.add_double_data(0.1);
  onnx::TensorProto truth = tensor(onnx::TensorProto::BOOL, {2});
  truth.set_raw_data(std::string("\1\0", 2));
  onnx::TensorProto small = tensor(onnx::TensorProto::INT32, {1});
  small.add_int32_data(-7);

  CHECK(read_onnx_tensor(wide, "w").floats == std::vector{0.1f});
  CHECK(read_onnx_tensor(truth, "w").integers == std::vector<std::int64_t>{1, 0});
  CHECK(read_onnx_tensor(small, "w").integers == std::vector<std::int64_t>{-7});
}

TEST_CASE("a tensor whose numbers do not fill its shape is refused") {
  onnx::TensorProto proto = tensor(onnx::TensorProto::FLOAT, {2, 2});
  proto.add_float_data(1.0f);
  CHECK(tensor_error(proto) == "x.onnx: tensor 'w': its shape asks for 4 numbers, but the file holds 1");

  proto = tensor(onnx::TensorProto::FLOAT, {1});
  proto.set_raw_data("abcde");
  CHECK(tensor_error(proto) != "");
}

TEST_CASE("a tensor of hostile sizes is refused before memory is spent") {
  const std::int64_t huge = std::int64_t{1} << 62;
  CHECK(tensor_error(tensor(onnx::TensorProto::FLOAT, {huge, huge, huge})).find("too large") != std::string::npos);
  CHECK(tensor_error(tensor(onnx::TensorProto::FLOAT, {0, huge})).find("too large") != std::string::npos);
  CHECK(tensor_error(tensor(onnx::TensorProto::FLOAT, {1 << 13, 1 << 13})).find("too large") != std::string::npos);
  CHECK(tensor_error(tensor(onnx::TensorProto::FLOAT, {-1})).find("must be >= 0") != std::string::npos);
  CHECK(tensor_error(tensor(onnx::TensorProto::FLOAT, std::vector<std::int64_t>(9, 1))).find("9 dimensions") !=
        std::string::npos);
}

TEST_CASE("a tensor of another type or place is refused with the remedy") {
  CHECK(tensor_error(tensor(onnx::TensorProto::FLOAT16, {1})).find("float16; save the policy as float32") !=
        std::string::npos);
  CHECK(tensor_error(tensor(static_cast<onnx::TensorProto::DataType>(16), {1})).find("bfloat16") != std::string::npos);

  onnx::TensorProto outside = tensor(onnx::TensorProto::FLOAT, {1});
  outside.set_data_location(onnx::TensorProto::EXTERNAL);
  CHECK(tensor_error(outside).find("which is not at hand") != std::string::npos);

  onnx::TensorProto cut = tensor(onnx::TensorProto::FLOAT, {1});
  cut.mutable_segment()->set_begin(0);
  CHECK(tensor_error(cut).find("segments") != std::string::npos);
}
