#include "gust/onnx/data.h"

#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <vector>

#include "gust/onnx/fixture.h"

using namespace gust;

namespace {

using Entries = std::vector<std::pair<std::string, std::string>>;

/// action = obs * w with the weights (1, 10, 100) in a data file.
OnnxFixture outside(const Entries& entries) {
  OnnxFixture file;
  onnx::TensorProto& weights = file.floats("w", {3}, {});
  weights.set_data_location(onnx::TensorProto::EXTERNAL);
  for (const auto& [key, value] : entries) {
    weights.add_external_data()->set_key(key);
    weights.mutable_external_data()->rbegin()->set_value(value);
  }
  file.node("Mul", {"obs", "w"}, "action");
  return file;
}

std::string weights_after(std::size_t bytes) {
  const float weights[] = {1, 10, 100};
  std::string data(bytes + sizeof weights, 'x');
  std::memcpy(data.data() + bytes, weights, sizeof weights);
  return data;
}

std::string why(const OnnxFixture& file, const OnnxData& data) {
  try {
    read_onnx(file.bytes(), "p.onnx", {.data = &data});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string why_named(const std::string& location) {
  try {
    onnx_data_files(outside({{"location", location}}).bytes(), "p.onnx");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("weights are read from a data file, at their place in it") {
  const OnnxFixture file = outside({{"location", "p.onnx.data"}, {"offset", "64"}, {"length", "12"}});
  const OnnxData data = {{"p.onnx.data", weights_after(64) + "more"}};

  const OnnxModel model = read_onnx(file.bytes(), "p.onnx", {.data = &data});

  std::vector<float> action(3);
  OnnxRunner(model).run(std::vector<float>{1, 2, 3}, 1, action);
  CHECK(action == std::vector<float>{1, 20, 300});
  CHECK(onnx_data_files(file.bytes(), "p.onnx") == std::vector<std::string>{"p.onnx.data"});
  CHECK(onnx_data_files("no onnx file", "p.onnx").empty());
}

TEST_CASE("without offset and length a tensor is the whole data file") {
  CHECK(why(outside({{"location", "d"}}), {{"d", weights_after(0)}}) == "");
  CHECK(why(outside({{"location", "d"}}), {{"d", weights_after(4)}}) ==
        "p.onnx: tensor 'w': its shape asks for 3 numbers, but the file holds 4");
}

TEST_CASE("weights that are not in the data file are refused") {
  const OnnxData data = {{"d", weights_after(0)}};
  const auto at = [&](const char* offset, const char* length) {
    return why(outside({{"location", "d"}, {"offset", offset}, {"length", length}}), data);
  };
  CHECK(at("0", "12") == "");
  CHECK(at("4", "12").find("needs 12 bytes from byte 4 on of the file 'd', which has 12") != std::string::npos);
  CHECK(at("18446744073709551615", "12").find("which has 12") != std::string::npos);
  CHECK(at("12", "18446744073709551615").find("which has 12") != std::string::npos);
  CHECK(at("0", "8").find("asks for 3 numbers, but the file holds 2") != std::string::npos);
  for (const char* bad : {"-1", "1e1", " 0", "0x0", "18446744073709551616", ""}) {
    CHECK(at(bad, "12").find("it must be a whole number") != std::string::npos);
  }
  CHECK(why(outside({{"location", "other"}}), data).find("in the file 'other', which is not at hand") !=
        std::string::npos);
}

TEST_CASE("only plain names of files beside the ONNX file are data files") {
  CHECK(why_named("p.onnx.data") == "");
  const std::vector<std::string> others = {"",    ".",    "..",   "/etc/passwd",        "../d",
                                           "a/b", "a\\b", "a\nb", std::string(256, 'x')};
  for (const std::string& bad : others) {
    CAPTURE(bad);
    CHECK(why_named(bad).find("only a file in the folder of the ONNX file itself is read") != std::string::npos);
  }
}
