#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "gust/core/error.h"
#include "gust/nn/mlp.h"

namespace gust {

/// What tests compare with: tests/reference/nn/pytorch.txt, every line a name and its numbers.
inline std::map<std::string, std::vector<double>> read_reference(const std::string& path) {
  std::map<std::string, std::vector<double>> reference;
  std::ifstream file(path);
  GUST_CHECK(file.good());
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    for (double number; words >> number;) reference[name].push_back(number);
  }
  return reference;
}

/// Calls visit(position) for every parameter, its position in the flat buffer, in PyTorch's order: layer after layer,
/// weights [output][input], then biases.
template <class T, class Visit>
void for_each_parameter(const Mlp<T>& mlp, Visit&& visit) {
  const MlpShape& shape = mlp.shape();
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    const DenseShape size = {shape.sizes[layer], shape.sizes[layer + 1]};
    for (std::size_t output = 0; output < size.outputs; ++output)
      for (std::size_t input = 0; input < size.inputs; ++input)
        visit(mlp.weights_at(layer) + size.index(output, input));
    for (std::size_t output = 0; output < size.outputs; ++output) visit(mlp.biases_at(layer) + output);
  }
}

}  // namespace gust
