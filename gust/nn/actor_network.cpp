#include "gust/nn/actor_network.h"

#include <algorithm>

#include "gust/nn/activation.h"

namespace gust {

ActorNetwork at_level(const ActorNetwork& actor, float alpha) {
  if (!actor.alpha) return actor;
  MlpShape shape = actor.mlp.shape();
  const std::size_t level = --shape.sizes.front();  // the input that goes
  ActorNetwork result{.mlp = Mlp<float>(shape), .box = actor.box};
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    for (std::size_t output = 0; output < shape.sizes[layer + 1]; ++output) {
      result.mlp.bias(layer, output) = actor.mlp.bias(layer, output);
      for (std::size_t input = 0; input < shape.sizes[layer]; ++input)
        result.mlp.weight(layer, output, input) = actor.mlp.weight(layer, output, input);
    }
  }
  for (std::size_t output = 0; output < shape.sizes[1]; ++output)
    result.mlp.bias(0, output) += alpha * actor.mlp.weight(0, output, level);
  return result;
}

template <class T>
void squash(const ActionBox& box, std::span<T> actions) noexcept {
  const std::size_t width = box.centre.size();
  for (std::size_t i = 0; i < actions.size(); ++i)
    actions[i] = activate<Activation::kTanh, T>(actions[i]) * static_cast<T>(box.half_width[i % width]) +
                 static_cast<T>(box.centre[i % width]);
}

template void squash(const ActionBox&, std::span<float>) noexcept;
template void squash(const ActionBox&, std::span<double>) noexcept;

ActorRunner::ActorRunner(const ActorNetwork& actor, std::size_t max_lanes)
    : actor_(actor.alpha ? at_level(actor, *actor.alpha) : actor),
      workspace_(actor_.mlp.shape(), max_lanes),
      actions_(max_lanes * actor_.actions()) {}

std::span<const float> ActorRunner::act(std::span<const float> observation) noexcept {
  const std::span<const float> sums = workspace_.forward(actor_.mlp, observation);
  if (!actor_.box) return sums;
  const std::span<float> actions(actions_.data(), sums.size());
  std::ranges::copy(sums, actions.begin());
  squash(*actor_.box, actions);
  return actions;
}

}  // namespace gust
