#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/onnx.h"

namespace {

void expect(bool claim) {
  if (!claim) std::terminate();
}

/// Two lanes together act as each of them does alone.
void run(const gust::OnnxModel& model) {
  gust::OnnxRunner runner(model);
  std::vector<float> observations(2 * model.observations());
  for (std::size_t i = 0; i < observations.size(); ++i) observations[i] = 0.25f * static_cast<float>(i % 7) - 0.75f;
  std::vector<float> together(2 * model.actions());
  runner.run(observations, 2, together);
  std::vector<float> alone(model.actions());
  runner.run(std::span(observations).subspan(model.observations()), 1, alone);
  expect(std::memcmp(alone.data(), together.data() + model.actions(), alone.size() * sizeof(float)) == 0);
}

}  // namespace

/// Input: an ONNX file, which is each of its own data files. Whatever it is, reading gives a network that runs, or one
/// Error; and what is written from it reads back as the same network.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    gust::OnnxData files;
    for (const std::string& name : gust::onnx_data_files(bytes, "fuzz.onnx")) files[name] = bytes;
    const gust::OnnxModel model = gust::read_onnx(bytes, "fuzz.onnx", {.data = &files});
    run(model);
    if (!model.actor) return 0;
    const gust::OnnxModel again = gust::read_onnx(gust::write_onnx(*model.actor, model.metadata), "written.onnx");
    expect(again.actor && again.metadata == model.metadata && again.actor->box == model.actor->box);
    expect(again.actor->mlp.shape() == model.actor->mlp.shape());
    expect(std::ranges::equal(again.actor->mlp.parameters(), model.actor->mlp.parameters()));
  } catch (const gust::Error&) {
  }
  return 0;
}
