#include "gust/onnx/graph.h"

#include <algorithm>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/onnx/output.h"
#include "gust/onnx/proto.h"

namespace gust {
namespace {

constexpr std::int64_t kNewestOpset = 30;  // operators of later ones may mean something else
constexpr std::int64_t kOldestOpset = 7;   // since then values broadcast as they do today

std::string describe(const onnx::NodeProto& node) {
  const std::string& name = !node.name().empty() || node.output_size() == 0 ? node.name() : node.output(0);
  return cat("node ", onnx_quoted(name), " of type ", onnx_quoted(node.op_type()));
}

bool is_recurrent(const onnx::NodeProto& node) {
  static constexpr std::string_view kRecurrent[] = {"LSTM", "GRU", "RNN", "Scan", "Loop"};
  return std::find(std::begin(kRecurrent), std::end(kRecurrent), node.op_type()) != std::end(kRecurrent);
}

// Who defines each name of a graph, and the walk from the action back to the observation.
class GraphReader {
 public:
  GraphReader(const onnx::ModelProto& model, std::string_view file, const OnnxData& data)
      : model_(model), graph_(model.graph()), data_(data) {
    out_.file = file;
  }

  /// The graph of the output of that name; if it is empty, of the one that is the action.
  OnnxGraph read(std::string_view output);

 private:
  enum class Mark { kOpen, kDone };
  struct Visit {
    int node;
    int next_input;
  };

  void check_opset();
  void index_names();
  void collect_nodes();
  void visit_input(Visit& visit, std::vector<Visit>& path);
  void need_value(const std::string& name, const std::string& reader);
  OnnxTensor read_tensor(const onnx::TensorProto& proto, const std::string& what);
  void read_input();
  void find_level();
  OnnxNode read_node(const onnx::NodeProto& proto);
  std::optional<OnnxAttribute> read_attribute(const onnx::AttributeProto& proto, const std::string& node);
  OnnxDims declared_dims(const onnx::ValueInfoProto& info) const;
  std::vector<std::string> cycle_names(const std::vector<Visit>& path, int node) const;
  [[noreturn]] void fail(const std::string& what) const { throw Error(cat(out_.file, ": ", what)); }

  const onnx::ModelProto& model_;
  const onnx::GraphProto& graph_;
  const OnnxData& data_;
  OnnxGraph out_;
  std::unordered_map<std::string, int> producers_;  // node that writes a name
  std::unordered_map<std::string, int> initializers_;
  std::unordered_map<std::string, int> inputs_;
  std::unordered_map<int, Mark> marks_;
  std::set<std::string> needed_inputs_;
  std::size_t elements_ = 0;
};

OnnxGraph GraphReader::read(std::string_view output) {
  if (!model_.has_graph()) fail("holds no graph; it is not an ONNX model, or it is cut short");
  check_opset();
  index_names();
  const onnx::ValueInfoProto& chosen = choose_onnx_output(graph_, output, out_.file);
  out_.output = chosen.name();
  out_.output_dims = declared_dims(chosen);
  collect_nodes();
  read_input();
  find_level();
  for (const auto& entry : model_.metadata_props()) out_.metadata[entry.key()] = entry.value();
  return std::move(out_);
}

void GraphReader::check_opset() {
  for (const auto& set : model_.opset_import()) {
    if (set.domain().empty() || set.domain() == "ai.onnx") out_.opset = std::max(out_.opset, set.version());
  }
  if (out_.opset == 0) fail("names no opset of ai.onnx; it is not an ONNX model, or it is cut short");
  if (out_.opset > kNewestOpset) fail(cat("is of opset ", out_.opset, "; the newest that is known is ", kNewestOpset));
  if (out_.opset < kOldestOpset) {
    fail(cat("is of opset ", out_.opset, "; opset ", kOldestOpset,
             " or later is needed (onnx.version_converter can convert it)"));
  }
}

void GraphReader::index_names() {
  const auto once = [&](bool fresh, const std::string& name) {
    if (!fresh) fail(cat(onnx_quoted(name), " is defined twice; every value of a graph has one name of its own"));
  };
  for (int i = 0; i < graph_.initializer_size(); ++i) {
    const std::string& name = graph_.initializer(i).name();
    once(initializers_.emplace(name, i).second, name);
  }
  for (int i = 0; i < graph_.input_size(); ++i) {
    const std::string& name = graph_.input(i).name();
    if (!initializers_.contains(name)) once(inputs_.emplace(name, i).second, name);  // before IR 4 both lists had it
  }
  for (int i = 0; i < graph_.node_size(); ++i) {
    for (const std::string& name : graph_.node(i).output()) {
      if (name.empty()) continue;  // an optional output left out
      once(!initializers_.contains(name) && !inputs_.contains(name) && producers_.emplace(name, i).second, name);
    }
  }
}

// Depth first from the output to its inputs, without recursion: hostile graphs are deep.
void GraphReader::collect_nodes() {
  std::vector<Visit> path;
  need_value(out_.output, "the output of the graph");
  if (const auto producer = producers_.find(out_.output); producer != producers_.end()) {
    path.push_back({producer->second, 0});
    marks_[producer->second] = Mark::kOpen;
  }
  while (!path.empty()) {
    Visit& top = path.back();
    const onnx::NodeProto& node = graph_.node(top.node);
    if (top.next_input < node.input_size()) {
      visit_input(top, path);
      continue;
    }
    if (is_recurrent(node)) {
      fail(cat(describe(node),
               ": is recurrent, and a policy here keeps nothing from one step to the next; train a"
               " feed-forward network, or give it the last observations as part of the observation"));
    }
    out_.nodes.push_back(read_node(node));
    marks_[top.node] = Mark::kDone;
    path.pop_back();
  }
}

void GraphReader::visit_input(Visit& visit, std::vector<Visit>& path) {
  const onnx::NodeProto& node = graph_.node(visit.node);
  const std::string& name = node.input(visit.next_input++);
  if (name.empty()) return;  // an optional input left out
  need_value(name, describe(node));
  const auto producer = producers_.find(name);
  if (producer == producers_.end()) return;
  const auto [mark, fresh] = marks_.emplace(producer->second, Mark::kOpen);
  if (fresh) {
    path.push_back({producer->second, 0});
  } else if (mark->second == Mark::kOpen) {
    fail(cat("the graph has a cycle through ", join(cycle_names(path, producer->second), ", "),
             "; a policy must be feed-forward"));
  }
}

std::vector<std::string> GraphReader::cycle_names(const std::vector<Visit>& path, int node) const {
  std::vector<std::string> names;
  const auto start = std::find_if(path.begin(), path.end(), [&](const Visit& visit) { return visit.node == node; });
  for (auto at = start; at != path.end() && names.size() < 8; ++at) names.push_back(describe(graph_.node(at->node)));
  return names;
}

void GraphReader::need_value(const std::string& name, const std::string& reader) {
  if (producers_.contains(name)) return;
  if (inputs_.contains(name)) {
    needed_inputs_.insert(name);
  } else if (const auto at = initializers_.find(name); at != initializers_.end()) {
    if (!out_.constants.contains(name)) {
      out_.constants.emplace(name, read_tensor(graph_.initializer(at->second), cat("tensor ", onnx_quoted(name))));
    }
  } else {
    fail(cat(reader, ": needs ", onnx_quoted(name), ", which no node, initializer or input defines"));
  }
}

OnnxTensor GraphReader::read_tensor(const onnx::TensorProto& proto, const std::string& what) {
  OnnxTensor tensor = read_onnx_tensor(proto, cat(out_.file, ": ", what), data_);
  elements_ += tensor.size();
  if (elements_ > kOnnxElements) fail(cat("holds more than ", kOnnxElements, " weights, the limit for a policy"));
  return tensor;
}

void GraphReader::read_input() {
  std::vector<std::string> names;
  for (const std::string& name : needed_inputs_) names.push_back(onnx_quoted(name));
  if (names.empty()) fail("the action does not depend on any input of the graph; a policy reads the observation");
  if (names.size() > 1) {
    names.resize(std::min<std::size_t>(names.size(), 8));
    fail(cat("the action needs the inputs ", join(names, ", "),
             "; a policy has one input, the observation. A recurrent network, whose state is an input, cannot be used;"
             " the parts of an observation must be joined to one before the export"));
  }
  out_.input = *needed_inputs_.begin();
  const onnx::ValueInfoProto& info = graph_.input(inputs_.at(out_.input));
  const int type = info.type().tensor_type().elem_type();
  if (type != onnx::TensorProto::FLOAT && type != onnx::TensorProto::DOUBLE) {
    fail(cat("input ", names[0], " is of type ", onnx_type_name(type), "; the observation must be float32 or float64"));
  }
  OnnxDims dims = declared_dims(info);
  const bool batched = dims.size() > 1;
  const bool sized = std::all_of(dims.begin() + (batched ? 1 : 0), dims.end(), [](auto dim) { return dim > 0; });
  if (dims.empty() || !sized) {
    fail(cat("input ", names[0], " has no fixed number of observations; its shape must be [N, n] with a given n"));
  }
  if (batched) out_.fixed_batch = std::max<std::int64_t>(dims[0], 0);
  if (batched && dims[0] != 1) dims[0] = kOnnxBatch;
  out_.input_dims = std::move(dims);
}

void GraphReader::find_level() {
  const auto constant = out_.constants.find("alpha");
  if (constant == out_.constants.end() || constant->second.floats.size() != 1) return;
  const auto& inputs = graph_.input();
  out_.conditional = std::any_of(inputs.begin(), inputs.end(), [](const auto& info) { return info.name() == "alpha"; });
}

OnnxDims GraphReader::declared_dims(const onnx::ValueInfoProto& info) const {
  OnnxDims dims;
  const onnx::TensorShapeProto& shape = info.type().tensor_type().shape();
  if (shape.dim_size() > kOnnxRank) {
    fail(cat(onnx_quoted(info.name()), " has ", shape.dim_size(), " dimensions; the limit is ", kOnnxRank));
  }
  for (const auto& dim : shape.dim()) dims.push_back(dim.has_dim_value() ? dim.dim_value() : kOnnxBatch);
  return dims;
}

OnnxNode GraphReader::read_node(const onnx::NodeProto& proto) {
  OnnxNode node{.name = describe(proto), .op = proto.op_type(), .inputs = {}, .outputs = {}, .attributes = {}};
  if (!proto.domain().empty() && proto.domain() != "ai.onnx") node.op = cat(proto.domain(), ".", proto.op_type());
  node.inputs.assign(proto.input().begin(), proto.input().end());
  node.outputs.assign(proto.output().begin(), proto.output().end());
  for (const auto& attribute : proto.attribute()) {
    auto value = read_attribute(attribute, node.name);
    if (value) node.attributes.insert_or_assign(attribute.name(), *std::move(value));
  }
  return node;
}

std::optional<OnnxAttribute> GraphReader::read_attribute(const onnx::AttributeProto& proto, const std::string& node) {
  switch (proto.type()) {
    case onnx::AttributeProto::FLOAT:
      return proto.f();
    case onnx::AttributeProto::INT:
      return proto.i();
    case onnx::AttributeProto::STRING:
      return proto.s();
    case onnx::AttributeProto::FLOATS:
      return std::vector<float>(proto.floats().begin(), proto.floats().end());
    case onnx::AttributeProto::INTS:
      return std::vector<std::int64_t>(proto.ints().begin(), proto.ints().end());
    case onnx::AttributeProto::TENSOR:
      return read_tensor(proto.t(), node);
    default:
      return std::nullopt;  // sub-graphs and the like: no operator that we take has them
  }
}

}  // namespace

std::string onnx_quoted(std::string_view name) {
  constexpr std::size_t kLongest = 80;
  std::string text = "'";
  for (const char c : name.substr(0, kLongest)) text += c >= ' ' && c != 127 ? c : '?';
  return text + (name.size() > kLongest ? "...'" : "'");
}

OnnxGraph read_onnx_graph(std::string_view bytes, std::string_view name, std::string_view output,
                          const OnnxData& data) {
  const OnnxMessage model = parse_onnx(bytes, name);
  return GraphReader(*model, name, data).read(output);
}

}  // namespace gust
