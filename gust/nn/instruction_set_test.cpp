#include <doctest/doctest.h>
#include <libxsmm.h>

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "gust/core/hash.h"
#include "gust/core/rng.h"
#include "gust/nn/initialise.h"
#include "gust/nn/product.h"
#include "gust/nn/trained_mlp.h"

using namespace gust;

namespace {

constexpr char kChild[] = "GUST_PRINT_NETWORK_BITS";  // compiled for the processor that it names

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
  TrainedMlp<float> network(shape, kLanes, {.first = 0, .count = 1}, TrainedMlp<float>::Target::kYes);
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
  for (const Mlp<float>* mlp : {&std::as_const(network).mlp(), &network.target()})
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

/// What this test program prints in another environment.
std::string bits_in(const std::string& environment, const std::string& target = "") {
  const std::string command = environment + " " + kChild + "='" + target +
                              "' /proc/$PPID/exe --no-version=true --test-case='*instructions libxsmm*'";
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
  if (const char* target = std::getenv(kChild)) {
    REQUIRE(products_are_compiled());
    if (*target != '\0') libxsmm_set_target_arch(target);
    std::printf("bits:%s\n", all_bits().c_str());
    return;
  }

  const std::string here = all_bits();

  CHECK(bits_in("", "hsw") == here);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq")) {
    CHECK(bits_in("", "skx") == here);
    CHECK(bits_in("", "cpx") == here);
  }
  CHECK(bits_in("", "snb") != here);  // two roundings: what must not happen
  for (const char* target : {"0", "1", "sse3", "wsm", "snb", "hsw", "skx", "nonsense"})
    CHECK(bits_in(std::string("LIBXSMM_TARGET=") + target) == here);
}
