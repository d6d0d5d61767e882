#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gust {

// How large a policy may be; beyond it a file is refused before memory is spent on it.
inline constexpr std::size_t kOnnxElements = std::size_t{1} << 24;  ///< most numbers in all constants together
inline constexpr std::size_t kOnnxWidth = std::size_t{1} << 18;  ///< most numbers in all intermediate values of a lane
inline constexpr int kOnnxRank = 8;                              ///< most dimensions of a value

/// The size that stands for the batch among the dimensions of a value that depends on the observation. Every
/// lane of a batch is a run of the network by itself.
inline constexpr std::int64_t kOnnxBatch = -1;

/// The sizes of a value, outermost first; none make a scalar.
using OnnxDims = std::vector<std::int64_t>;

/// A constant of an ONNX graph in row-major order: either floats (float32, or float64 rounded to it) or integers
/// (int32, int64, bool).
struct OnnxTensor {
  OnnxDims dims;
  std::vector<float> floats;
  std::vector<std::int64_t> integers;
  bool integral = false;
  bool truths = false;  ///< integers that are 1 and 0

  std::size_t size() const { return integral ? integers.size() : floats.size(); }
};

}  // namespace gust
