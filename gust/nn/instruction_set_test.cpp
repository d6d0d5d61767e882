#include <doctest/doctest.h>

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "gust/core/hash.h"
#include "gust/core/rng.h"
#include "gust/nn/initialise.h"
#include "gust/nn/trained_mlp.h"

using namespace gust;

namespace {

constexpr char kChild[] = "GUST_PRINT_NETWORK_BITS";

/// Trains a network a little and hashes everything that came out on the way.
std::string trained_bits(const MlpShape& shape) {
  Mlp<float> mlp(shape);
  initialise_uniform(mlp, Rng(9));
  MlpWorkspace<float> workspace(shape, 100);
  AdamState<float> adam(mlp.parameters().size());
  Buffer<float> gradient(mlp.parameters().size());
  std::string bytes;
  for (const std::size_t lanes : {1, 4, 25, 64, 100}) {
    Buffer<float> x(lanes * shape.inputs()), dy(lanes * shape.outputs());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<float>(Rng(lanes).normal(i));
    const auto y = workspace.forward(mlp, x);
    for (std::size_t i = 0; i < y.size(); ++i) dy[i] = y[i] - 0.5f;
    workspace.backward(mlp, dy, gradient);
    adam_step<float>({}, adam, mlp.parameters(), gradient);
    bytes.append(reinterpret_cast<const char*>(y.data()), y.size_bytes());
  }
  bytes.append(reinterpret_cast<const char*>(mlp.parameters().data()), mlp.parameters().size_bytes());
  return hash_hex(bytes);
}

/// The same of a network in tiles.
std::string tiled_bits(const MlpShape& shape) {
  constexpr std::size_t kLanes = 100;
  TrainedMlp<float> network(shape, kLanes, {.first = 0, .count = 1}, TrainedMlp<float>::Follower::kYes);
  initialise_uniform(network.mlp(), Rng(9));
  Tiles<float> x(kLanes, shape.inputs()), dy(kLanes, shape.outputs());
  float slope = 0.0f;
  for (int step = 0; step < 3; ++step) {
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      for (std::size_t i = 0; i < shape.inputs(); ++i)
        x.at(lane, i) = static_cast<float>(Rng(step).normal(lane * shape.inputs() + i));
    const Tiles<float>& y = network.forward(x);
    for (std::size_t lane = 0; lane < kLanes; ++lane) dy.at(lane, 0) = y.at(lane, 0) - 0.5f;
    slope += network.backward_to_input(dy).at(77, 0);
    network.step({}, dy, 0.1f);
  }
  std::string bytes(reinterpret_cast<const char*>(&slope), sizeof slope);
  for (const Mlp<float>* mlp : {&std::as_const(network).mlp(), &network.follower()})
    bytes.append(reinterpret_cast<const char*>(mlp->parameters().data()), mlp->parameters().size_bytes());
  return hash_hex(bytes);
}

std::string all_bits() {
  std::string bits;
  for (const MlpShape& shape :
       {MlpShape{{4, 64, 64, 1}}, MlpShape{{6, 100, 72, 2}}, MlpShape{{5, 256, 256, 1}, Activation::kRelu}}) {
    bits += trained_bits(shape) + tiled_bits(shape);
  }
  return bits;
}

/// What this test program prints when libxsmm is told to compile for another processor.
std::string bits_for(const std::string& target) {
  const std::string command = "LIBXSMM_TARGET=" + target + " " + kChild +
                              "=1 /proc/$PPID/exe --no-version=true --test-case='*instructions libxsmm*'";
  std::FILE* output = popen(command.c_str(), "r");
  REQUIRE(output != nullptr);
  std::string text;
  for (int letter; (letter = std::fgetc(output)) != EOF;) text += static_cast<char>(letter);
  CHECK(pclose(output) == 0);
  const std::size_t at = text.find("bits:");
  return at == std::string::npos ? text : text.substr(at + 5, all_bits().size());
}

}  // namespace

TEST_CASE("networks train to the same bits whatever instructions libxsmm may use") {
  if (std::getenv(kChild) != nullptr) {
    std::printf("bits:%s\n", all_bits().c_str());
    return;
  }

  const std::string here = all_bits();

  CHECK(bits_for("hsw") == here);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq")) {
    CHECK(bits_for("skx") == here);
    CHECK(bits_for("cpx") == here);
  }
}
