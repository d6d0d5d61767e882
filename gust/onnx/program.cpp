#include "gust/onnx/program.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gust/core/error.h"

namespace gust {
namespace {

Product<float> product_of(const OnnxDense& dense, std::size_t rows) {
  const auto outputs = static_cast<int>(dense.outputs);
  const auto inputs = static_cast<int>(dense.inputs);
  return Product<float>({.m = outputs, .n = static_cast<int>(rows), .k = inputs});
}

void add_bias(const OnnxDense& dense, std::span<float> rows) {
  for (float* row = rows.data(); row != rows.data() + rows.size(); row += dense.outputs) {
    for (std::size_t j = 0; j < dense.outputs; ++j) row[j] += dense.bias[j];
  }
}

void add_sources(const OnnxOperand& operand, std::vector<std::size_t>& sources) {
  if (operand.row.empty()) sources.push_back(operand.buffer);
}

/// The buffers that a step reads.
template <class Step>
std::vector<std::size_t> sources_of(const Step& step) {
  return {step.from};
}
template <>
std::vector<std::size_t> sources_of(const OnnxConstant&) {
  return {};
}
template <>
std::vector<std::size_t> sources_of(const OnnxCombine& combine) {
  std::vector<std::size_t> sources;
  for (const OnnxOperand* operand : {&combine.left, &combine.right}) add_sources(*operand, sources);
  return sources;
}
template <>
std::vector<std::size_t> sources_of(const OnnxChoose& choice) {
  std::vector<std::size_t> sources;
  for (const OnnxOperand* operand : {&choice.condition, &choice.left, &choice.right}) add_sources(*operand, sources);
  return sources;
}
template <>
std::vector<std::size_t> sources_of(const OnnxPick& pick) {
  std::vector<std::size_t> sources;
  for (const OnnxPick::Source& source : pick.sources) sources.push_back(source.buffer);
  return sources;
}

/// Running numbers of a reduction, in double.
struct Running {
  double sum = 0, product = 1, squares = 0, sizes = 0;
};

float reduced(OnnxReduction reduction, std::span<const float> numbers) {
  Running running;
  float low = numbers[0];
  float high = numbers[0];
  for (const float x : numbers) {
    running.sum += x;
    running.product *= x;
    running.squares += double{x} * x;
    running.sizes += x < 0.0f ? -double{x} : double{x};
    low = low <= x || low != low ? low : x;  // NaN stays NaN
    high = high >= x || high != high ? high : x;
  }
  switch (reduction) {
    case OnnxReduction::kSum:
      return static_cast<float>(running.sum);
    case OnnxReduction::kMean:
      return static_cast<float>(running.sum / static_cast<double>(numbers.size()));
    case OnnxReduction::kProduct:
      return static_cast<float>(running.product);
    case OnnxReduction::kSumOfSquares:
      return static_cast<float>(running.squares);
    case OnnxReduction::kSumOfSizes:
      return static_cast<float>(running.sizes);
    case OnnxReduction::kLength:
      return static_cast<float>(std::sqrt(running.squares));
    case OnnxReduction::kMin:
      return low;
    case OnnxReduction::kMax:
      return high;
  }
  return 0.0f;
}

}  // namespace

void apply(const OnnxDense& dense, std::span<const float> from, float* to) {
  const auto rows = from.size() / dense.inputs;
  product_of(dense, rows).plain(dense.weights.data(), from.data(), to);
  add_bias(dense, {to, rows * dense.outputs});
}

void apply(const OnnxMap& map, std::span<const float> from, float* to) {
  apply(map.function, {map.a, map.b}, from, to);
}

void apply(const OnnxReduce& reduce, std::span<const float> from, float* to) {
  for (std::size_t at = 0; at < from.size(); at += reduce.run) {
    *to++ = reduced(reduce.reduction, from.subspan(at, reduce.run));
  }
}

void apply(const OnnxNormalise& normalise, std::span<const float> from, float* to) {
  const auto count = static_cast<double>(normalise.run);
  for (std::size_t at = 0; at < from.size(); at += normalise.run) {
    const std::span<const float> numbers = from.subspan(at, normalise.run);
    double mean = 0;
    for (const float x : numbers) mean += normalise.centred ? x : 0.0;
    mean /= count;
    double squares = 0;
    for (const float x : numbers) squares += (x - mean) * (x - mean);
    const double length = std::sqrt(squares / count + normalise.epsilon);
    for (const float x : numbers) *to++ = static_cast<float>((x - mean) / length);
  }
}

void choose(const float* condition, const float* left, const float* right, std::span<float> to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = condition[i] != 0.0f ? left[i] : right[i];
}

std::size_t OnnxProgram::add_buffer(std::size_t width) {
  widths.push_back(width);
  return widths.size() - 1;
}

void OnnxProgram::remove_unused() {
  std::vector<bool> used(widths.size(), false);
  used[result] = true;
  std::vector<OnnxStep> kept;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const bool needed = std::visit([&](const auto& kind) { return bool{used[kind.to]}; }, *step);
    if (!needed) continue;
    for (const std::size_t buffer : std::visit([](const auto& kind) { return sources_of(kind); }, *step)) {
      used[buffer] = true;
    }
    kept.push_back(std::move(*step));
  }
  std::reverse(kept.begin(), kept.end());
  steps = std::move(kept);
  for (std::size_t buffer = 1; buffer < widths.size(); ++buffer) {
    if (!used[buffer]) widths[buffer] = 0;
  }
}

OnnxProgramRunner::OnnxProgramRunner(OnnxProgram program) : program_(std::move(program)) {
  std::size_t total = 0;
  for (const std::size_t width : program_.widths) {
    offsets_.push_back(total);
    total += (width * kBlock + 15) / 16 * 16;
  }
  scratch_.assign(total, 0.0f);
  for (OnnxStep& step : program_.steps) {
    auto* dense = std::get_if<OnnxDense>(&step);
    if (dense != nullptr) dense->product = product_of(*dense, dense->rows * kBlock);
  }
}

void OnnxProgramRunner::run(std::span<const float> in, std::size_t lanes, std::span<float> out) {
  const std::size_t in_width = program_.widths[0];
  const std::size_t out_width = program_.widths[program_.result];
  GUST_CHECK(in.size() == lanes * in_width && out.size() == lanes * out_width);
  for (std::size_t lane = 0; lane < lanes; lane += kBlock) {
    const std::size_t count = std::min(kBlock, lanes - lane);
    float* first = buffer(0);
    std::copy_n(in.data() + lane * in_width, count * in_width, first);
    std::fill(first + count * in_width, first + kBlock * in_width, 0.0f);
    for (const OnnxStep& next : program_.steps) {
      std::visit([&](const auto& kind) { step(kind); }, next);
    }
    std::copy_n(buffer(program_.result), count * out_width, out.data() + lane * out_width);
  }
}

void OnnxProgramRunner::step(const OnnxDense& dense) {
  float* to = buffer(dense.to);
  dense.product(dense.weights.data(), buffer(dense.from), to);
  add_bias(dense, {to, dense.rows * kBlock * dense.outputs});
}

void OnnxProgramRunner::step(const OnnxMap& map) {
  const std::size_t size = program_.widths[map.from] * kBlock;
  apply(map, {buffer(map.from), size}, buffer(map.to));
}

const float* OnnxProgramRunner::row(const OnnxOperand& operand, std::size_t lane, std::size_t width) {
  return operand.row.empty() ? buffer(operand.buffer) + lane * width : operand.row.data();
}

void OnnxProgramRunner::step(const OnnxCombine& combine) {
  const std::size_t width = program_.widths[combine.to];
  for (std::size_t lane = 0; lane < kBlock; ++lane) {
    apply(combine.arithmetic, row(combine.left, lane, width), row(combine.right, lane, width),
          {buffer(combine.to) + lane * width, width});
  }
}

void OnnxProgramRunner::step(const OnnxChoose& choice) {
  const std::size_t width = program_.widths[choice.to];
  for (std::size_t lane = 0; lane < kBlock; ++lane) {
    choose(row(choice.condition, lane, width), row(choice.left, lane, width), row(choice.right, lane, width),
           {buffer(choice.to) + lane * width, width});
  }
}

void OnnxProgramRunner::step(const OnnxConstant& constant) {
  float* to = buffer(constant.to);
  for (std::size_t lane = 0; lane < kBlock; ++lane) to = std::copy(constant.row.begin(), constant.row.end(), to);
}

void OnnxProgramRunner::step(const OnnxReduce& reduce) {
  apply(reduce, {buffer(reduce.from), program_.widths[reduce.from] * kBlock}, buffer(reduce.to));
}

void OnnxProgramRunner::step(const OnnxNormalise& normalise) {
  apply(normalise, {buffer(normalise.from), program_.widths[normalise.from] * kBlock}, buffer(normalise.to));
}

void OnnxProgramRunner::step(const OnnxPick& pick) {
  const std::size_t width = pick.sources.size();
  float* to = buffer(pick.to);
  for (std::size_t j = 0; j < width; ++j) {
    const auto [source, element] = pick.sources[j];
    const float* from = buffer(source) + element;
    const std::size_t stride = program_.widths[source];
    for (std::size_t lane = 0; lane < kBlock; ++lane) to[lane * width + j] = from[lane * stride];
  }
}

}  // namespace gust
