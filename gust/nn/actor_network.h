#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "gust/nn/mlp.h"

namespace gust {

/// The interval of each action that a tanh is stretched over.
struct ActionBox {
  std::vector<float> centre;
  std::vector<float> half_width;

  friend bool operator==(const ActionBox&, const ActionBox&) = default;
};

/// A deterministic policy as a network computes it: what a training hands out, and what an ONNX file of ours holds.
///
///   action = mlp(observation)                               without a box
///   action = centre + half_width tanh(mlp(observation))     with one
///
/// A network that depends on a risk level takes it as its last input; `alpha` is the level that it acts at unless told
/// another.
struct ActorNetwork {
  Mlp<float> mlp;
  std::optional<ActionBox> box = {};
  std::optional<float> alpha = {};

  std::size_t observations() const { return mlp.shape().inputs() - (alpha ? 1 : 0); }
  std::size_t actions() const { return mlp.shape().outputs(); }
};

/// The actor at one risk level, which becomes part of its first biases: bias + alpha weight. One that takes no level
/// is returned as it is.
ActorNetwork at_level(const ActorNetwork& actor, float alpha);

/// Turns outputs of a network, lanes x actions, into actions within the box.
template <class T>
void squash(const ActionBox& box, std::span<T> actions) noexcept;

/// Runs an actor in float32, as it trains. One thread at a time.
class ActorRunner {
 public:
  ActorRunner(const ActorNetwork& actor, std::size_t max_lanes);

  /// From lanes x observations to lanes x actions, the numbers of a lane side by side; holds until the next call. The
  /// bits of a lane depend neither on the other lanes nor on their number.
  std::span<const float> act(std::span<const float> observation) noexcept;

 private:
  ActorNetwork actor_;
  MlpWorkspace<float> workspace_;
  Buffer<float> actions_;
};

}  // namespace gust
