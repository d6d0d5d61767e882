#include "gust/onnx/data.h"

#include <algorithm>
#include <set>

#include "gust/core/error.h"
#include "gust/onnx/graph.h"
#include "gust/onnx/proto.h"

namespace gust {
namespace {

constexpr std::size_t kMostFiles = 1024;
constexpr std::size_t kLongestName = 255;  // of a file on Linux

bool is_plain(const std::string& name) {
  const bool printable = std::none_of(name.begin(), name.end(), [](char c) { return (c >= 0 && c < ' ') || c == 127; });
  return printable && !name.empty() && name.size() <= kLongestName && name != "." && name != ".." &&
         name.find_first_of("/\\") == std::string::npos;
}

void add_file(const onnx::TensorProto& tensor, std::string_view file, std::set<std::string>& names) {
  if (tensor.data_location() != onnx::TensorProto::EXTERNAL) return;
  for (const auto& entry : tensor.external_data()) {
    if (entry.key() != "location") continue;
    const std::string& value = entry.value();
    if (!is_plain(value)) {
      throw Error(cat(file, ": tensor ", onnx_quoted(tensor.name()), ": its weights are to be read from ",
                      onnx_quoted(value), "; only a file in the folder of the ONNX file itself is read"));
    }
    names.insert(value);
  }
  if (names.size() > kMostFiles) throw Error(cat(file, ": keeps its weights in more than ", kMostFiles, " files"));
}

}  // namespace

std::vector<std::string> onnx_data_files(std::string_view bytes, std::string_view name) {
  OnnxMessage model;
  try {
    model = parse_onnx(bytes, name);
  } catch (const Error&) {
    return {};
  }
  std::set<std::string> names;
  for (const auto& tensor : model->graph().initializer()) add_file(tensor, name, names);
  for (const auto& node : model->graph().node()) {
    for (const auto& attribute : node.attribute()) add_file(attribute.t(), name, names);
  }
  return {names.begin(), names.end()};
}

}  // namespace gust
