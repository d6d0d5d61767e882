#pragma once

#include <span>
#include <vector>

#include "gust/nn/buffer.h"
#include "gust/nn/mlp.h"

namespace gust {

/// A float32 network, computed in double: what it says does not depend on the order in which float32 would add up.
///
/// Made for measuring a policy, where float32's rounding is amplified by a plant on the edge of falling. tanh is within
/// 2e-10 of the true value. The bits of a lane depend neither on the other lanes nor on the machine.
class WideMlp {
 public:
  /// Runs up to max_lanes lanes at a time. No call but this one allocates.
  WideMlp(const Mlp<float>& mlp, std::size_t max_lanes);

  std::size_t inputs() const { return layers_.front().inputs; }
  std::size_t outputs() const { return layers_.back().outputs; }

  /// From lanes x inputs to lanes x outputs, the numbers of a lane side by side. The result holds until the next call.
  std::span<const double> forward(std::span<const double> in) noexcept;

 private:
  struct Layer {
    std::size_t inputs;
    std::size_t outputs;
    std::size_t stride;      // outputs, rounded up to whole registers
    Activation activation;   // of its sums
    Buffer<double> weights;  // input by input, stride apart
    Buffer<double> biases;
  };

  struct Batch {
    const double* data;
    std::size_t stride;  // from lane to lane
  };

  static void multiply(const Layer& layer, const Batch& x, std::span<double> y) noexcept;

  std::vector<Layer> layers_;
  Buffer<double> buffers_[2];  // of layers 0, 2, … and 1, 3, …: lanes x stride
  std::vector<double> result_;
};

}  // namespace gust
