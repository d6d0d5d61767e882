#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/graph.h"
#include "gust/onnx/program.h"

namespace gust {

/// What a name of the graph stands for while it is turned into a program: a constant, or a buffer that depends on the
/// observation. One dimension of a buffer is kOnnxBatch, unless the model itself knows no batch.
struct OnnxValue {
  OnnxDims dims;
  const OnnxTensor* constant = nullptr;  ///< lives as long as the lowering
  std::size_t buffer = 0;
  bool whole = false;    ///< a buffer of integers in the file, held as floats
  bool literal = false;  ///< a constant that stands in the file: its -1 is no batch
  bool truth = false;    ///< a buffer of truths in the file, held as 1 and 0

  bool integral() const { return constant != nullptr ? constant->integral : whole; }
  bool is_truth() const { return constant != nullptr ? constant->truths : truth; }
};

/// How many numbers of a lane a dimension counts for: the batch is one.
inline std::int64_t lane_size(std::int64_t dim) { return dim == kOnnxBatch ? 1 : dim; }

/// Turns a graph into a program, node by node. An operator reads its node through this and builds values with it; what
/// depends on constants alone is computed at once.
class OnnxLowering {
 public:
  explicit OnnxLowering(OnnxGraph graph);

  /// The program of the whole graph. An Error names the node and says what would be right.
  OnnxProgram program();

  /// What is wrong with the node at hand.
  [[noreturn]] void fail(std::string_view what) const;

  // The node at hand.
  bool has_input(std::size_t index) const;
  const OnnxValue& input(std::size_t index) const;
  std::size_t inputs() const { return node_->inputs.size(); }
  std::size_t outputs() const { return node_->outputs.size(); }
  void set_output(std::size_t index, OnnxValue value);
  const OnnxAttribute* find_attribute(const std::string& name) const;

  /// An attribute, or the fallback where the node has none.
  template <class T>
  T attribute(const std::string& name, T fallback) const {
    const OnnxAttribute* found = find_attribute(name);
    if (found == nullptr) return fallback;
    const T* value = std::get_if<T>(found);
    if (value == nullptr) fail(cat("attribute ", onnx_quoted(name), " has the wrong type for this operator"));
    return *value;
  }

  /// Integers that an operator takes: from an input (which must be constant), or before some opset from an attribute.
  std::vector<std::int64_t> integers(std::size_t index, const std::string& attribute) const;

  /// A dimension's index; negative ones count from the end.
  std::size_t axis(std::int64_t index, std::size_t rank) const;

  /// The number of elements of a shape, the batch counted as one.
  std::size_t elements(const OnnxDims& dims) const;

  /// The size of the batch that the file was made for; 0 if it leaves it open, or makes no difference.
  std::int64_t fixed_batch() const { return graph_.fixed_batch; }
  std::int64_t opset() const { return graph_.opset; }

  // Building blocks.
  OnnxValue constant(OnnxTensor tensor);
  OnnxValue map(const OnnxValue& from, OnnxFunction function, float a = 0.0f, float b = 0.0f);
  OnnxValue combine(OnnxArithmetic arithmetic, const OnnxValue& left, const OnnxValue& right);
  OnnxValue choose(const OnnxValue& condition, const OnnxValue& left, const OnnxValue& right);
  OnnxValue number(float value) { return constant({.dims = {}, .floats = {value}, .integers = {}}); }

  /// One number for the elements along some axes, whose size becomes 1.
  OnnxValue reduce(OnnxReduction reduction, const OnnxValue& from, const std::vector<std::size_t>& axes);

  /// Every `run` elements that lie side by side, brought to a mean square of one; see OnnxNormalise.
  OnnxValue normalise(const OnnxValue& from, std::size_t run, float epsilon, bool centred);

  /// The same value with its axes in another order: axis i of the result is axis order[i].
  OnnxValue transposed(const OnnxValue& from, const std::vector<std::size_t>& order);

  /// A constant as floats.
  OnnxValue as_floats(const OnnxValue& value);

  /// from W + b: the last dimension of `from` are the inputs, weights and bias as in OnnxDense.
  OnnxValue dense(const OnnxValue& from, Buffer<float> weights, std::vector<float> bias);

  /// The elements of a value at some indices, as a value of another shape.
  OnnxValue pick(const OnnxValue& from, const std::vector<std::size_t>& indices, OnnxDims dims);

  /// A constant as a buffer that holds it in every lane.
  OnnxValue filled(const OnnxValue& from);

  /// Elements of buffers as a value of a shape.
  OnnxValue pick_many(std::vector<OnnxPick::Source> sources, OnnxDims dims);

  /// The same numbers under another shape.
  OnnxValue reshaped(OnnxValue from, OnnxDims dims);

  /// The same value repeated to fill a shape, and the shape that two values fill together (numpy's rules).
  OnnxValue broadcast(const OnnxValue& from, const OnnxDims& dims);
  OnnxDims broadcast_dims(const OnnxDims& left, const OnnxDims& right) const;

 private:
  void lower_node();
  void check_output(const OnnxValue& output) const;
  OnnxValue append(OnnxStep step, std::size_t buffer, OnnxDims dims);
  OnnxValue combine_integers(OnnxArithmetic arithmetic, const OnnxValue& left, const OnnxValue& right);

  /// A step from one value: computed at once if that is constant.
  template <class Step>
  OnnxValue append_from(const OnnxValue& from, Step step, OnnxDims dims) {
    if (from.constant != nullptr) {
      std::vector<float> result(elements(dims));
      apply(step, floats(from), result.data());
      return constant({.dims = std::move(dims), .floats = std::move(result), .integers = {}});
    }
    step.from = from.buffer;
    step.to = add_buffer(dims);
    const std::size_t buffer = step.to;
    return append(std::move(step), buffer, std::move(dims));
  }

  std::size_t add_buffer(const OnnxDims& dims);
  /// What a step reads. A constant must be finite, unless it is no weight: one that bounds or replaces a number.
  OnnxOperand operand(const OnnxValue& value, bool may_be_infinite) const;
  void check_finite(std::span<const float> numbers) const;
  const std::vector<float>& floats(const OnnxValue& value) const;
  void charge(std::size_t numbers);

  OnnxGraph graph_;
  OnnxProgram program_;
  const OnnxNode* node_ = nullptr;
  std::map<std::string, OnnxValue> values_;
  std::deque<OnnxTensor> computed_;  // constants that operators made; a deque, for values point to them
  std::size_t width_ = 0;
  std::size_t numbers_ = 0;
};

}  // namespace gust
