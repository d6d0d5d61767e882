#include "gust/onnx/output.h"

#include <algorithm>
#include <initializer_list>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/onnx/graph.h"

namespace gust {
namespace {

using Outputs = std::vector<const onnx::ValueInfoProto*>;

std::string described(const onnx::ValueInfoProto& info) {
  if (!info.type().tensor_type().has_shape()) return cat(onnx_quoted(info.name()), " of unknown shape");
  std::vector<std::string> sizes;
  for (const auto& dim : info.type().tensor_type().shape().dim()) {
    if (sizes.size() > 8) break;
    sizes.push_back(dim.has_dim_value() ? cat(dim.dim_value()) : sizes.empty() ? "N" : "?");
  }
  return cat(onnx_quoted(info.name()), " [", join(sizes, ", "), "]");
}

std::string list_of(const Outputs& outputs) {
  std::vector<std::string> texts;
  for (const onnx::ValueInfoProto* output : outputs) {
    if (texts.size() == 16) {
      texts.push_back("...");
      break;
    }
    texts.push_back(described(*output));
  }
  return join(texts, ", ");
}

std::string in_small_letters(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

Outputs named(const Outputs& outputs, std::initializer_list<std::string_view> names) {
  Outputs found;
  for (const onnx::ValueInfoProto* output : outputs) {
    const std::string name = in_small_letters(output->name());
    if (std::find(names.begin(), names.end(), name) != names.end()) found.push_back(output);
  }
  return found;
}

/// The names of a graph whose numbers are computed from those of an input. What is handed on unchanged, as states of
/// recurrent networks that are not in use, is not among them, nor what takes only the size of the batch.
std::set<std::string> computed_names(const onnx::GraphProto& graph) {
  std::unordered_map<std::string, std::vector<const onnx::NodeProto*>> readers;
  for (const onnx::NodeProto& node : graph.node()) {
    if (node.op_type() == "Shape" || node.op_type() == "Size") continue;
    for (const std::string& name : node.input()) readers[name].push_back(&node);
  }
  std::set<std::string> given;
  for (const auto& info : graph.input()) given.insert(info.name());
  for (const auto& tensor : graph.initializer()) given.erase(tensor.name());
  std::vector<std::string> pending(given.begin(), given.end());
  std::set<std::string> computed;
  while (!pending.empty()) {
    const std::string name = std::move(pending.back());
    pending.pop_back();
    for (const onnx::NodeProto* node : readers[name]) {
      const bool unchanged = node->op_type() == "Identity" && !computed.contains(name);
      for (const std::string& output : node->output()) {
        if ((unchanged ? given : computed).insert(output).second) pending.push_back(output);
      }
    }
  }
  return computed;
}

}  // namespace

const onnx::ValueInfoProto& choose_onnx_output(const onnx::GraphProto& graph, std::string_view wanted,
                                               std::string_view file) {
  Outputs outputs;
  std::vector<std::string> names;
  for (const auto& info : graph.output()) {
    outputs.push_back(&info);
    names.push_back(info.name());
    if (!wanted.empty() && info.name() == wanted) return info;
  }
  if (outputs.empty()) throw Error(cat(file, ": the graph has no output; the action should be one"));
  if (!wanted.empty()) {
    throw Error(
        cat(file, ": has no output ", onnx_quoted(wanted), did_you_mean(wanted, names), "; it has ", list_of(outputs)));
  }
  if (outputs.size() == 1) return *outputs.front();
  const std::set<std::string> computed = computed_names(graph);
  Outputs left = outputs;
  std::erase_if(left, [&](const onnx::ValueInfoProto* output) { return !computed.contains(output->name()); });
  for (const Outputs& known :
       {named(left, {"action", "actions"}), named(left, {"mu", "mean", "deterministic_continuous_actions"})}) {
    if (known.empty()) continue;
    left = known;
    break;
  }
  if (left.empty()) return *outputs.front();
  if (left.size() == 1) return *left.front();
  throw Error(cat(file, ": has more than one output that may be the action: ", list_of(left),
                  "; say which: output = ", "\"NAME\" in a study, --output NAME for gust eval"));
}

}  // namespace gust
