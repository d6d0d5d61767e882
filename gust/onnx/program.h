#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "gust/nn/buffer.h"
#include "gust/nn/product.h"
#include "gust/onnx/functions.h"

namespace gust {

/// to = from W + b, for each of `rows` rows of a lane. W lies input by input, outputs side by side; no bias is zeros.
struct OnnxDense {
  std::size_t from;
  std::size_t to;
  std::size_t rows;
  std::size_t inputs;
  std::size_t outputs;
  Buffer<float> weights;
  std::vector<float> bias;
  Product<float> product = {};  ///< OnnxProgramRunner makes it
};

/// to = f(from). a and b are the parameters of the function.
struct OnnxMap {
  std::size_t from;
  std::size_t to;
  OnnxFunction function;
  float a;
  float b;
};

/// A buffer, or the same row for every lane.
struct OnnxOperand {
  std::size_t buffer = 0;
  std::vector<float> row = {};
};

/// to = left ∘ right, element by element.
struct OnnxCombine {
  OnnxArithmetic arithmetic;
  OnnxOperand left;
  OnnxOperand right;
  std::size_t to;
};

/// to[j] = the element of the buffer that sources[j] names.
struct OnnxPick {
  struct Source {
    std::size_t buffer;
    std::size_t element;
  };
  std::size_t to;
  std::vector<Source> sources;
};

/// to = the row, in every lane.
struct OnnxConstant {
  std::size_t to;
  std::vector<float> row;
};

/// to[j] = the element of left or right, by whether the condition's is not 0.
struct OnnxChoose {
  OnnxOperand condition;
  OnnxOperand left;
  OnnxOperand right;
  std::size_t to;
};

/// to[j] = one number for `run` elements of from, beginning at j run.
struct OnnxReduce {
  std::size_t from;
  std::size_t to;
  OnnxReduction reduction;
  std::size_t run;
};

/// to = from / sqrt(mean of the squares + epsilon) over every `run` elements, the mean subtracted first if centred.
struct OnnxNormalise {
  std::size_t from;
  std::size_t to;
  std::size_t run;
  float epsilon;
  bool centred;
};

using OnnxStep =
    std::variant<OnnxDense, OnnxMap, OnnxCombine, OnnxPick, OnnxConstant, OnnxChoose, OnnxReduce, OnnxNormalise>;

/// Steps over float buffers, one of each width a lane; buffer 0 is the observation. Arithmetic is in float32, sums in
/// ascending order with fused multiply-add; functions, reductions and normalisations are rounded from double. The bits
/// of a lane do not depend on the number of lanes.
struct OnnxProgram {
  std::vector<std::size_t> widths;
  std::vector<OnnxStep> steps;
  std::size_t result = 0;

  /// Appends a buffer and gives its index.
  std::size_t add_buffer(std::size_t width);

  /// Removes the steps that the result does not depend on.
  void remove_unused();
};

/// to = from W + b for rows of inputs, whatever the buffers and the rows of the step.
void apply(const OnnxDense& dense, std::span<const float> from, float* to);

/// What a step makes of some numbers, whatever the buffers of the step.
void apply(const OnnxMap& map, std::span<const float> from, float* to);
void apply(const OnnxReduce& reduce, std::span<const float> from, float* to);
void apply(const OnnxNormalise& normalise, std::span<const float> from, float* to);

/// to[i] = left[i] if condition[i] is not 0, else right[i].
void choose(const float* condition, const float* left, const float* right, std::span<float> to);

/// Runs a program again and again; holds its buffers. One thread at a time.
class OnnxProgramRunner {
 public:
  static constexpr std::size_t kBlock = 8;  ///< lanes that run at a time

  explicit OnnxProgramRunner(OnnxProgram program);

  /// From lanes × widths[0] to lanes × widths[result] numbers; a lane's numbers lie side by side.
  void run(std::span<const float> in, std::size_t lanes, std::span<float> out);

 private:
  float* buffer(std::size_t index) { return scratch_.data() + offsets_[index]; }
  void step(const OnnxDense& dense);
  void step(const OnnxMap& map);
  void step(const OnnxCombine& combine);
  void step(const OnnxPick& pick);
  void step(const OnnxConstant& constant);
  void step(const OnnxChoose& choice);
  void step(const OnnxReduce& reduce);
  void step(const OnnxNormalise& normalise);
  const float* row(const OnnxOperand& operand, std::size_t lane, std::size_t width);

  OnnxProgram program_;
  std::vector<std::size_t> offsets_;
  Buffer<float> scratch_;
};

}  // namespace gust
