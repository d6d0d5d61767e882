// onnx_run MODEL.onnx: reads observations as float32 from the standard input until it ends, and writes a line "n m
// kind" (kind is mlp or program), then the actions as float32. onnx_run --rewrite MODEL.onnx: writes the network as
// gust writes its own; onnx_run --conditional ALPHA MODEL.onnx: the same, its last input being a risk level. onnx_run
// --output NAME MODEL.onnx: runs another output; onnx_run --operators: the names of all operators. A file that is
// refused: exit 2 and the message on the standard error.
#include <cstddef>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/onnx.h"
#include "gust/onnx/operators.h"
#include "gust/study/text/policy_files.h"

namespace {

std::string read_all(std::istream& in) { return {std::istreambuf_iterator<char>(in), {}}; }

gust::OnnxModel read_model(const std::string& path, const std::string& output = {}) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes = read_all(file);
  const gust::OnnxData data = gust::read_onnx_data(path, bytes);
  return gust::read_onnx(bytes, path, {.output = output, .data = &data});
}

void rewrite(const std::string& path, std::optional<float> alpha) {
  gust::OnnxModel model = read_model(path);
  if (!model.actor) throw gust::Error(gust::cat(path, ": is no chain of linear layers with one kind of activation"));
  model.actor->alpha = alpha;
  std::cout << gust::write_onnx(*model.actor, model.metadata);
}

void run(const std::string& path, const std::string& output = {}) {
  const gust::OnnxModel model = read_model(path, output);
  const std::string bytes = read_all(std::cin);
  const std::size_t lanes = bytes.size() / sizeof(float) / model.observations();
  std::vector<float> observations(lanes * model.observations());
  std::memcpy(observations.data(), bytes.data(), observations.size() * sizeof(float));
  std::vector<float> actions(lanes * model.actions());

  gust::OnnxRunner(model).run(observations, lanes, actions);

  std::cout << model.observations() << ' ' << model.actions() << ' ' << (model.actor ? "mlp" : "program") << '\n';
  const auto size = static_cast<std::streamsize>(actions.size() * sizeof(float));
  std::cout.write(reinterpret_cast<const char*>(actions.data()), size);
}

}  // namespace

int main(int count, char** arguments) try {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.size() == 2 && words[0] == "--rewrite") {
    rewrite(words[1], {});
  } else if (words.size() == 3 && words[0] == "--conditional") {
    rewrite(words[2], std::stof(words[1]));
  } else if (words.size() == 1 && words[0] == "--operators") {
    std::cout << gust::onnx_operator_names() << '\n';
  } else if (words.size() == 3 && words[0] == "--output") {
    run(words[2], words[1]);
  } else if (words.size() == 1) {
    run(words[0]);
  } else {
    throw gust::Error("usage: onnx_run --operators | [--rewrite | --conditional ALPHA | --output NAME] MODEL.onnx");
  }
} catch (const gust::Error& error) {
  std::cerr << error.what() << '\n';
  return 2;
} catch (const std::exception& error) {
  std::cerr << "failure: " << error.what() << '\n';
  return 1;
}
