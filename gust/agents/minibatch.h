#pragma once

#include <vector>

#include "gust/agents/replay.h"
#include "gust/nn/tiles.h"

namespace gust {

/// Transitions sampled from the replay buffer, as the networks take them. What a transition carries besides (a risk
/// level) is the last input of actor and critics alike, and the same before and after the step.
struct Minibatch {
  Minibatch(const TransitionShape& transition, std::size_t lanes);

  /// Gathers rows of the memory. An actor's action is filled in by whoever asks for one.
  void gather(const Replay& replay, std::span<const std::int64_t> rows);

  /// Sets component `index` of the extras in all inputs of a lane.
  void set_extra(std::size_t lane, std::size_t index, float value);

  std::size_t lanes() const { return reward.size(); }

  TransitionShape shape;
  Tiles<float> observation;  ///< what the actor sees: observation | extra
  Tiles<float> next;
  Tiles<float> taken;       ///< what critics judge: observation | action of the memory | extra
  Tiles<float> acted;       ///< observation | action of the present policy | extra
  Tiles<float> next_acted;  ///< next observation | action of the present policy | extra
  std::vector<float> reward;
  std::vector<float> alive;  ///< 1, or 0 where the episode failed
};

}  // namespace gust
