#pragma once

#include <onnx/onnx.pb.h>

#include <cstddef>
#include <string_view>

#include "gust/nn/onnx_data.h"
#include "gust/nn/onnx_tensor.h"

namespace gust {

// The messages of an ONNX file. What the readers hand on knows nothing of protobuf: only .cpp files include this.

inline constexpr std::size_t kOnnxFields = 500'000;  ///< most fields, numbers of float tensors not counted

/// The message in some bytes. An Error that starts with `name` for what is too large, has more fields than a network
/// needs, or is no such message; memory stays within a small multiple of the size of the bytes.
onnx::ModelProto parse_onnx(std::string_view bytes, std::string_view name);

/// The constant in a message, its numbers perhaps in a data file; `where` starts the Error for a type, size or place of
/// storage that is not supported, and for numbers that lie outside the data file or do not fill the shape.
OnnxTensor read_onnx_tensor(const onnx::TensorProto& proto, std::string_view where, const OnnxData& data = {});

/// The name of a TensorProto::DataType as the user knows it, such as "float16".
std::string_view onnx_type_name(int data_type);

}  // namespace gust
