#pragma once

#include <google/protobuf/arena.h>
#include <onnx/onnx.pb.h>

#include <cstddef>
#include <memory>
#include <string_view>

#include "gust/onnx/data.h"
#include "gust/onnx/tensor.h"

namespace gust {

// The messages of an ONNX file. What the readers hand on knows nothing of protobuf: only .cpp files include this.

inline constexpr std::size_t kOnnxFields = 500'000;  ///< most fields, numbers of float tensors not counted

/// A model in an arena, which frees what is there even where memory ran out while a message was filled: a message of
/// its own then has parts that were never made, and its destructor would read them.
class OnnxMessage {
 public:
  OnnxMessage()
      : arena_(std::make_unique<google::protobuf::Arena>()),
        model_(google::protobuf::Arena::CreateMessage<onnx::ModelProto>(arena_.get())) {}

  onnx::ModelProto& operator*() const { return *model_; }
  onnx::ModelProto* operator->() const { return model_; }

 private:
  std::unique_ptr<google::protobuf::Arena> arena_;
  onnx::ModelProto* model_;
};

/// The message in some bytes. An Error that starts with `name` for what is too large, has more fields than a network
/// needs, or is no such message; memory stays within a small multiple of the size of the bytes.
OnnxMessage parse_onnx(std::string_view bytes, std::string_view name);

/// The constant in a message, its numbers perhaps in a data file; `where` starts the Error for a type, size or place of
/// storage that is not supported, and for numbers that lie outside the data file or do not fill the shape.
OnnxTensor read_onnx_tensor(const onnx::TensorProto& proto, std::string_view where, const OnnxData& data = {});

/// The name of a TensorProto::DataType as the user knows it, such as "float16".
std::string_view onnx_type_name(int data_type);

}  // namespace gust
