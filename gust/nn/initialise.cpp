#include "gust/nn/initialise.h"

#include <cmath>
#include <vector>

namespace gust {
namespace {

using Vector = std::vector<double>;

/// `count` orthonormal vectors of a size that is no smaller. Twice is enough (Kahan and Parlett).
std::vector<Vector> orthonormal(std::size_t count, std::size_t size, Rng rng) {
  std::vector<Vector> vectors(count, Vector(size));
  for (std::size_t i = 0; i < count; ++i) {
    Vector& vector = vectors[i];
    for (std::size_t j = 0; j < size; ++j) vector[j] = rng.normal(i * size + j);
    for (std::size_t pass = 0; pass < 2 * i; ++pass) {
      const Vector& other = vectors[pass % i];
      double overlap = 0.0;
      for (std::size_t j = 0; j < size; ++j) overlap = std::fma(vector[j], other[j], overlap);
      for (std::size_t j = 0; j < size; ++j) vector[j] = std::fma(-overlap, other[j], vector[j]);
    }
    double square = 0.0;
    for (const double value : vector) square = std::fma(value, value, square);
    for (double& value : vector) value /= std::sqrt(square);
  }
  return vectors;
}

}  // namespace

template <class T>
void initialise_uniform(Mlp<T>& mlp, Rng rng) {
  const MlpShape& shape = mlp.shape();
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    const std::size_t inputs = shape.sizes[layer];
    const double bound = 1.0 / std::sqrt(static_cast<double>(inputs));
    const Rng weights = rng.split(layer).split("weights");
    const Rng biases = rng.split(layer).split("biases");
    const auto draw = [bound](Rng stream, std::size_t i) {
      return static_cast<T>(bound * (1.0 - 0x1p-24) * (2.0 * stream.uniform(i) - 1.0));  // rounding stays within bound
    };
    for (std::size_t output = 0; output < shape.sizes[layer + 1]; ++output) {
      for (std::size_t input = 0; input < inputs; ++input)
        mlp.weight(layer, output, input) = draw(weights, output * inputs + input);
      mlp.bias(layer, output) = draw(biases, output);
    }
  }
}

template <class T>
void initialise_orthogonal(Mlp<T>& mlp, OrthogonalGains gains, Rng rng) {
  const MlpShape& shape = mlp.shape();
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    const std::size_t inputs = shape.sizes[layer];
    const std::size_t outputs = shape.sizes[layer + 1];
    const double gain = layer + 1 == shape.layers() ? gains.output : gains.hidden;
    const bool tall = outputs > inputs;
    const auto q =
        tall ? orthonormal(inputs, outputs, rng.split(layer)) : orthonormal(outputs, inputs, rng.split(layer));
    for (std::size_t output = 0; output < outputs; ++output) {
      for (std::size_t input = 0; input < inputs; ++input)
        mlp.weight(layer, output, input) = static_cast<T>(gain * (tall ? q[input][output] : q[output][input]));
      mlp.bias(layer, output) = T(0);
    }
  }
}

template void initialise_uniform(Mlp<float>&, Rng);
template void initialise_uniform(Mlp<double>&, Rng);
template void initialise_orthogonal(Mlp<float>&, OrthogonalGains, Rng);
template void initialise_orthogonal(Mlp<double>&, OrthogonalGains, Rng);

}  // namespace gust
