// onnx_run MODEL.onnx: reads observations as float32 from the standard input until it ends, and writes a line "n m kind" (kind
// is mlp or program), then the actions as float32. A file that is refused: exit 2 and the message on the standard error.
#include <cstddef>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "gust/core/error.h"
#include "gust/nn/onnx.h"

namespace {

std::string read_all(std::istream& in) { return {std::istreambuf_iterator<char>(in), {}}; }

void run(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const gust::OnnxModel model = gust::read_onnx(read_all(file), path);
  const std::string bytes = read_all(std::cin);
  const std::size_t lanes = bytes.size() / sizeof(float) / model.observations();
  std::vector<float> observations(lanes * model.observations());
  std::memcpy(observations.data(), bytes.data(), observations.size() * sizeof(float));
  std::vector<float> actions(lanes * model.actions());

  gust::OnnxRunner(model).run(observations, lanes, actions);

  std::cout << model.observations() << ' ' << model.actions() << ' ' << (model.mlp ? "mlp" : "program") << '\n';
  const auto size = static_cast<std::streamsize>(actions.size() * sizeof(float));
  std::cout.write(reinterpret_cast<const char*>(actions.data()), size);
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 2) throw gust::Error("usage: onnx_run MODEL.onnx");
  run(arguments[1]);
} catch (const gust::Error& error) {
  std::cerr << error.what() << '\n';
  return 2;
} catch (const std::exception& error) {
  std::cerr << "failure: " << error.what() << '\n';
  return 1;
}
