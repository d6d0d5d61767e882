#pragma once

#include <array>
#include <cstddef>

#include "gust/nn/product.h"

namespace gust {

/// A product that runs over the lanes of a batch in blocks of 64, 16, 4 and 1. Its bits do not depend on how many lanes
/// there are, for every block adds up in the same order.
template <class T>
class LaneProduct {
 public:
  /// How far a, b and c advance from lane to lane, in elements; what does not advance is shared by all lanes.
  struct Steps {
    std::size_t a = 0;
    std::size_t b = 0;
    std::size_t c = 0;
  };

  LaneProduct() = default;

  /// Compiles one product a block size: lanes are the columns n of the shape, or its depth k if sum_over_lanes.
  LaneProduct(ProductShape shape, Steps steps, bool sum_over_lanes);

  void operator()(const T* a, const T* b, T* c, std::size_t lanes) const noexcept {
    for (std::size_t size = 0; size < kBlocks.size(); ++size) {
      const std::size_t block = kBlocks[size];
      for (; lanes >= block; lanes -= block) {
        products_[size](a, b, c);
        a += block * steps_.a;
        b += block * steps_.b;
        c += block * steps_.c;
      }
    }
  }

 private:
  static constexpr std::array<std::size_t, 4> kBlocks = {64, 16, 4, 1};

  std::array<Product<T>, 4> products_;
  Steps steps_;
};

/// Size of a linear layer, and how its weights lie in memory.
///
/// A wide layer keeps them input by input (the outputs of an input side by side); a narrow one, of at most 16 outputs,
/// output by output, and is computed as inner products.
struct DenseShape {
  std::size_t inputs;
  std::size_t outputs;

  bool narrow() const { return outputs <= 16; }

  /// Where the weight from an input to an output lies.
  std::size_t index(std::size_t output, std::size_t input) const {
    return narrow() ? output * inputs + input : input * outputs + output;
  }
};

/// The three products of a linear layer y = W x. A batch holds the features of a lane side by side: x is lanes x
/// inputs, y is lanes x outputs.
template <class T>
class Dense {
 public:
  explicit Dense(DenseShape shape);

  /// y = W x.
  void forward(const T* weights, const T* x, T* y, std::size_t lanes) const noexcept;

  /// dW += sum over lanes of dy x^T, each weight in the order of the lanes.
  void add_weight_gradient(const T* x, const T* dy, T* gradient, std::size_t lanes) const noexcept;

  /// dx = W^T dy, from the weights as output_major() gave them.
  void input_gradient(const T* by_output, const T* dy, T* dx, std::size_t lanes) const noexcept {
    input_gradient_(by_output, dy, dx, lanes);
  }

  /// The weights output by output: those of a narrow layer themselves, those of a wide one transposed into scratch.
  const T* output_major(const T* weights, T* scratch) const noexcept;

 private:
  DenseShape shape_;
  LaneProduct<T> forward_;
  LaneProduct<T> weight_gradient_;
  LaneProduct<T> input_gradient_;
};

}  // namespace gust
