#include "gust/onnx/proto.h"

#include <google/protobuf/io/coded_stream.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>

#include "gust/core/error.h"
#include "gust/onnx/graph.h"

namespace gust {
namespace {

using google::protobuf::io::CodedInputStream;

static_assert(std::endian::native == std::endian::little, "raw_data is little-endian");

// How a field is written: the low three bits of its tag (protobuf's encoding).
constexpr std::uint32_t kVarint = 0;
constexpr std::uint32_t kFixed64 = 1;
constexpr std::uint32_t kBytes = 2;
constexpr std::uint32_t kFixed32 = 5;

constexpr int kDeepest = 32;  // messages in messages

// Messages within messages, by field number. A leaf has no entry as a parent: its fields are counted and not entered.
enum class Message {
  kModel,
  kTraining,
  kFunction,
  kGraph,
  kNode,
  kAttribute,
  kTensor,
  kSparse,
  kInfo,
  kType,
  kTypeValue,
  kMap,
  kShape,
  kLeaf
};
using enum Message;

struct Nested {
  Message parent;
  int field;
  Message child;
};
using Attribute = onnx::AttributeProto;
using Function = onnx::FunctionProto;
using Graph = onnx::GraphProto;
using Model = onnx::ModelProto;
using Sparse = onnx::SparseTensorProto;
using Tensor = onnx::TensorProto;
using Training = onnx::TrainingInfoProto;
using Type = onnx::TypeProto;
constexpr Nested kNested[] = {
    {kModel, Model::kGraphFieldNumber, kGraph},
    {kModel, Model::kOpsetImportFieldNumber, kLeaf},
    {kModel, Model::kMetadataPropsFieldNumber, kLeaf},
    {kModel, Model::kTrainingInfoFieldNumber, kTraining},
    {kModel, Model::kFunctionsFieldNumber, kFunction},
    {kTraining, Training::kInitializationFieldNumber, kGraph},
    {kTraining, Training::kAlgorithmFieldNumber, kGraph},
    {kTraining, Training::kInitializationBindingFieldNumber, kLeaf},
    {kTraining, Training::kUpdateBindingFieldNumber, kLeaf},
    {kFunction, Function::kNodeFieldNumber, kNode},
    {kFunction, Function::kOpsetImportFieldNumber, kLeaf},
    {kGraph, Graph::kNodeFieldNumber, kNode},
    {kGraph, Graph::kInitializerFieldNumber, kTensor},
    {kGraph, Graph::kSparseInitializerFieldNumber, kSparse},
    {kGraph, Graph::kInputFieldNumber, kInfo},
    {kGraph, Graph::kOutputFieldNumber, kInfo},
    {kGraph, Graph::kValueInfoFieldNumber, kInfo},
    {kGraph, Graph::kQuantizationAnnotationFieldNumber, kLeaf},
    {kNode, onnx::NodeProto::kAttributeFieldNumber, kAttribute},
    {kAttribute, Attribute::kTFieldNumber, kTensor},
    {kAttribute, Attribute::kGFieldNumber, kGraph},
    {kAttribute, Attribute::kSparseTensorFieldNumber, kSparse},
    {kAttribute, Attribute::kTpFieldNumber, kType},
    {kAttribute, Attribute::kTensorsFieldNumber, kTensor},
    {kAttribute, Attribute::kGraphsFieldNumber, kGraph},
    {kAttribute, Attribute::kSparseTensorsFieldNumber, kSparse},
    {kAttribute, Attribute::kTypeProtosFieldNumber, kType},
    {kTensor, Tensor::kExternalDataFieldNumber, kLeaf},
    {kTensor, Tensor::kSegmentFieldNumber, kLeaf},
    {kSparse, Sparse::kValuesFieldNumber, kTensor},
    {kSparse, Sparse::kIndicesFieldNumber, kTensor},
    {kInfo, onnx::ValueInfoProto::kTypeFieldNumber, kType},
    {kType, Type::kTensorTypeFieldNumber, kTypeValue},
    {kType, Type::kSparseTensorTypeFieldNumber, kTypeValue},
    {kType, Type::kSequenceTypeFieldNumber, kTypeValue},
    {kType, Type::kMapTypeFieldNumber, kMap},
    {kType, Type::kOptionalTypeFieldNumber, kTypeValue},
    {kTypeValue, 1, kType},   // element type of a sequence or an optional
    {kTypeValue, 2, kShape},  // shape of a tensor, dense or sparse
    {kMap, onnx::TypeProto_Map::kValueTypeFieldNumber, kType},
    {kShape, onnx::TensorShapeProto::kDimFieldNumber, kLeaf},
};

// Packed integers may take one byte in the file; in memory they take eight.
bool is_packed_integers(Message message, int field) {
  if (message == kAttribute) return field == Attribute::kIntsFieldNumber;
  if (message == kSparse) return field == Sparse::kDimsFieldNumber;
  return message == kTensor && (field == Tensor::kDimsFieldNumber || field == Tensor::kInt32DataFieldNumber ||
                                field == Tensor::kInt64DataFieldNumber || field == Tensor::kUint64DataFieldNumber);
}

// Counts the fields of a message before protobuf makes objects of them: an empty sub-message is two bytes in the file
// and hundreds in memory.
class FieldCount {
 public:
  /// Counts the fields of a message up to the limit of the stream; stops early if it is malformed or has too many.
  void walk(CodedInputStream& in, Message message, int depth);

  bool too_many() const { return fields_ > kOnnxFields; }
  bool malformed() const { return malformed_; }

 private:
  bool skip_value(CodedInputStream& in, Message message, std::uint32_t tag, int depth);
  bool enter(CodedInputStream& in, Message message, int field, int depth);

  std::size_t fields_ = 0;
  bool malformed_ = false;
};

void FieldCount::walk(CodedInputStream& in, Message message, int depth) {
  if (depth > kDeepest) malformed_ = true;
  while (!too_many() && !malformed_ && in.BytesUntilLimit() > 0) {
    const std::uint32_t tag = in.ReadTagNoLastTag();
    malformed_ = tag == 0 || !skip_value(in, message, tag, depth) || malformed_;
    fields_ += message == kTensor && (tag & 7) == kFixed32 ? 0 : 1;
  }
}

bool FieldCount::skip_value(CodedInputStream& in, Message message, std::uint32_t tag, int depth) {
  std::uint64_t ignored = 0;
  switch (tag & 7) {
    case kVarint:
      return in.ReadVarint64(&ignored);
    case kFixed64:
      return in.Skip(8);
    case kFixed32:
      return in.Skip(4);
    case kBytes:
      return enter(in, message, static_cast<int>(tag >> 3), depth);
    default:
      return false;  // groups, which this schema does not have
  }
}

bool FieldCount::enter(CodedInputStream& in, Message message, int field, int depth) {
  std::uint32_t length = 0;
  if (!in.ReadVarint32(&length) || length > kOnnxBytes || static_cast<int>(length) > in.BytesUntilLimit()) return false;
  if (is_packed_integers(message, field)) fields_ += length;
  for (const Nested& nested : kNested) {
    if (nested.parent != message || nested.field != field) continue;
    const auto outer = in.PushLimit(static_cast<int>(length));
    walk(in, nested.child, depth + 1);
    in.PopLimit(outer);
    return true;
  }
  return in.Skip(static_cast<int>(length));
}

std::size_t element_count(const Tensor& proto, std::string_view where) {
  if (proto.dims_size() > kOnnxRank) {
    throw Error(cat(where, ": has ", proto.dims_size(), " dimensions; the limit is ", kOnnxRank));
  }
  std::size_t count = 1;
  bool empty = false;
  for (const std::int64_t dim : proto.dims()) {
    if (dim < 0) throw Error(cat(where, ": has the dimension ", dim, "; a size must be >= 0"));
    empty = empty || dim == 0;
    const auto size = static_cast<std::uint64_t>(std::max<std::int64_t>(dim, 1));
    if (size > kOnnxElements || (count *= size) > kOnnxElements) {
      throw Error(cat(where, ": is too large; the limit is ", kOnnxElements, " numbers"));
    }
  }
  return empty ? 0 : count;
}

std::size_t data_position(const Tensor& proto, std::string_view key, std::size_t standard, std::string_view where) {
  for (const auto& entry : proto.external_data()) {
    if (entry.key() != key) continue;
    const std::string& text = entry.value();
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error == std::errc{} && end == text.data() + text.size()) return number;
    throw Error(cat(where, ": has the ", key, " ", onnx_quoted(text), " in its data file; it must be a whole number"));
  }
  return standard;
}

// The bytes of a tensor that a data file holds.
std::string_view bytes_outside(const Tensor& proto, std::string_view where, const OnnxData& data) {
  std::string location;
  for (const auto& entry : proto.external_data()) {
    if (entry.key() == "location") location = entry.value();
  }
  const auto file = data.find(location);
  if (file == data.end()) {
    throw Error(cat(where, ": its weights are in the file ", onnx_quoted(location),
                    ", which is not at hand; keep it beside the ONNX file, or save the model as one file"
                    " (torch.onnx.export(..., external_data=False))"));
  }
  const std::size_t size = file->second.size();
  const std::size_t offset = data_position(proto, "offset", 0, where);
  const std::size_t length = data_position(proto, "length", size - std::min(offset, size), where);
  if (offset > size || length > size - offset) {
    throw Error(cat(where, ": needs ", length, " bytes from byte ", offset, " on of the file ", onnx_quoted(location),
                    ", which has ", size, "; it is cut short, or belongs to another policy"));
  }
  return std::string_view(file->second).substr(offset, length);
}

// Where the numbers of a tensor are, if not in the field of their type.
struct Storage {
  std::string_view raw;
  bool is_raw = false;
};

// Integers that hold weights only where a network is quantised.
bool is_quantised(int data_type) {
  return data_type == Tensor::INT8 || data_type == Tensor::UINT8 || data_type == Tensor::INT16 ||
         data_type == Tensor::UINT16;
}

// The numbers of a tensor as To.
template <class From, class To, class Field>
std::vector<To> numbers(const Tensor& proto, const Field& field, const Storage& storage, std::string_view where) {
  const std::size_t count = element_count(proto, where);
  const std::string_view raw = storage.raw;
  const bool is_raw = storage.is_raw && (!raw.empty() || field.empty());
  const std::size_t given = is_raw ? raw.size() / sizeof(From) : static_cast<std::size_t>(field.size());
  if (given != count || (is_raw && raw.size() % sizeof(From) != 0)) {
    throw Error(cat(where, ": its shape asks for ", count, " numbers, but the file holds ", given));
  }
  std::vector<To> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    From value;
    if (is_raw) {
      std::memcpy(&value, raw.data() + i * sizeof(From), sizeof value);
    } else {
      value = static_cast<From>(field[static_cast<int>(i)]);
    }
    values[i] = static_cast<To>(value);
  }
  return values;
}

}  // namespace

OnnxMessage parse_onnx(std::string_view bytes, std::string_view name) {
  if (bytes.empty()) throw Error(cat(name, ": is empty; expected an ONNX file"));
  if (bytes.size() > kOnnxBytes) {
    throw Error(cat(name, ": has ", bytes.size(), " bytes; the limit for a policy is ", kOnnxBytes));
  }
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  CodedInputStream count_stream(data, size);
  count_stream.PushLimit(size);
  FieldCount count;
  count.walk(count_stream, kModel, 0);
  if (count.too_many()) {
    throw Error(cat(name, ": is no policy network: it has more than ", kOnnxFields, " nodes, names and integers"));
  }
  OnnxMessage model;
  if (count.malformed() || !model->ParseFromArray(data, size)) {
    throw Error(cat(name, ": is not an ONNX file, or it is damaged or cut short"));
  }
  return model;
}

OnnxTensor read_onnx_tensor(const onnx::TensorProto& proto, std::string_view where, const OnnxData& data) {
  const bool outside = proto.data_location() == Tensor::EXTERNAL;
  const Storage storage = {outside ? bytes_outside(proto, where, data) : std::string_view(proto.raw_data()),
                           outside || proto.has_raw_data()};
  if (proto.has_segment()) throw Error(cat(where, ": is stored in segments; save the model with whole tensors"));
  OnnxTensor tensor;
  tensor.dims.assign(proto.dims().begin(), proto.dims().end());
  switch (proto.data_type()) {
    case Tensor::FLOAT:
      tensor.floats = numbers<float, float>(proto, proto.float_data(), storage, where);
      return tensor;
    case Tensor::DOUBLE:
      tensor.floats = numbers<double, float>(proto, proto.double_data(), storage, where);
      return tensor;
    case Tensor::INT32:
      tensor.integers = numbers<std::int32_t, std::int64_t>(proto, proto.int32_data(), storage, where);
      break;
    case Tensor::INT64:
      tensor.integers = numbers<std::int64_t, std::int64_t>(proto, proto.int64_data(), storage, where);
      break;
    case Tensor::BOOL:
      tensor.integers = numbers<std::uint8_t, std::int64_t>(proto, proto.int32_data(), storage, where);
      tensor.truths = true;
      break;
    default:
      throw Error(cat(where, ": has the type ", onnx_type_name(proto.data_type()), "; save the policy as float32",
                      is_quantised(proto.data_type()) ? ", before it is quantised" : ""));
  }
  tensor.integral = true;
  return tensor;
}

std::string_view onnx_type_name(int data_type) {
  constexpr std::array<std::string_view, 17> kNames = {
      "undefined", "float32", "uint8",   "int8",   "uint16", "int16",     "int32",      "int64",   "string",
      "bool",      "float16", "float64", "uint32", "uint64", "complex64", "complex128", "bfloat16"};
  const auto index = static_cast<std::size_t>(data_type);
  return data_type >= 0 && index < kNames.size() ? kNames[index] : "unknown to this version";
}

}  // namespace gust
