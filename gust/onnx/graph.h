#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gust/onnx/data.h"
#include "gust/onnx/tensor.h"

namespace gust {

using OnnxAttribute =
    std::variant<float, std::int64_t, std::string, std::vector<float>, std::vector<std::int64_t>, OnnxTensor>;

/// A name of a file within a message: quoted, printable, and no longer than a line.
std::string onnx_quoted(std::string_view name);

struct OnnxNode {
  std::string name;  ///< for messages: "node 'fc1' (Gemm)"
  std::string op;    ///< with its domain if that is not ONNX's own: "com.microsoft.Gelu"
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  std::map<std::string, OnnxAttribute> attributes;
};

/// What the action needs of an ONNX graph: one observation in, one action out, and the nodes between them in an order
/// in which they can be computed.
struct OnnxGraph {
  std::string file;  ///< starts every message
  std::int64_t opset = 0;
  std::string input;
  std::string output;
  OnnxDims input_dims;           ///< kOnnxBatch first, unless the file knows no batch or one of a single lane
  std::int64_t fixed_batch = 0;  ///< the size of the batch that the file was made for; 0 if it leaves it open
  OnnxDims output_dims;          ///< as declared, kOnnxBatch for what is left open; empty if the file says nothing
  std::vector<OnnxNode> nodes;
  std::map<std::string, OnnxTensor> constants;
  bool conditional = false;  ///< constant 'alpha', one float, is the default of an input of that name
  std::map<std::string, std::string> metadata;
};

/// Reads the part of an ONNX file that computes its action; `output` and `data` are those of OnnxReading. What else the
/// file computes is left out, so it may use anything. An Error that starts with `name` for a damaged file, an opset
/// below 7, cycles, recurrent nodes, names that nothing or more than one thing defines, no input or several, and sizes
/// beyond all reason.
OnnxGraph read_onnx_graph(std::string_view bytes, std::string_view name, std::string_view output = {},
                          const OnnxData& data = {});

}  // namespace gust
