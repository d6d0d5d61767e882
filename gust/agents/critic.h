#pragma once

#include <span>

#include "gust/agents/archive.h"
#include "gust/agents/minibatch.h"
#include "gust/core/rng.h"

namespace gust {

/// What critics say of actions.
struct Judgement {
  std::span<float> value;   ///< per lane; what the actor raises
  Tiles<float>& at_action;  ///< its gradient at the actions
};

/// A minibatch whose next actions were drawn from the present policy.
struct UpdateBatch {
  const Minibatch& batch;                   ///< taken, next_acted, reward, alive
  std::span<const float> next_log_density;  ///< of the next actions
  double temperature = 0;                   ///< the weight of the entropy that is part of what follows
  Rng rng;                                  ///< this update's own stream
};

/// Whatever judges actions and learns from transitions: all that tells soft actor-critic from what is built on it.
/// One thread at a time.
class Critic {
 public:
  virtual ~Critic() = default;

  /// Judges states with actions: observation | action | extra. `rng` is this update's own stream.
  virtual void judge(const Tiles<float>& input, Rng rng, Judgement judgement) = 0;

  /// One gradient step of every critic towards reward + discount alive (what follows - temperature log density), and
  /// one of their target networks towards them. Returns the loss.
  virtual double update(const UpdateBatch& update) = 0;

  virtual bool finite() const = 0;
  virtual void save(Saver& saver) const = 0;
  virtual void load(Loader& loader) = 0;
};

}  // namespace gust
