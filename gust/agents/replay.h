#pragma once

#include <cstdint>
#include <span>

#include "gust/agents/archive.h"
#include "gust/core/rng.h"
#include "gust/nn/buffer.h"

namespace gust {

/// What a transition is made of, in the order in which a row of the memory holds it.
struct TransitionShape {
  std::size_t observations = 0;
  std::size_t actions = 0;
  std::size_t extras = 0;  ///< what else a transition carries, the same before and after the step: a risk level

  std::size_t width() const { return 2 * observations + actions + extras + 2; }
  std::size_t action_at() const { return observations; }
  std::size_t extra_at() const { return action_at() + actions; }
  std::size_t next_at() const { return extra_at() + extras; }
  std::size_t reward_at() const { return next_at() + observations; }
  std::size_t alive_at() const { return reward_at() + 1; }
};

/// One step of one environment. An episode that time alone ended is still alive, and `next` is its own last observation
/// (docs/algorithms.md 2.2).
struct Transition {
  std::span<const float> observation;
  std::span<const float> action;
  std::span<const float> extra;
  std::span<const float> next;
  float reward = 0;
  bool terminated = false;
};

/// The bytes that so many transitions take when all are there.
std::uint64_t replay_bytes(const TransitionShape& shape, std::int64_t capacity);

/// The last transitions of a training, in float32, each one row side by side. It grows as it is filled; when it is full
/// the oldest goes.
class Replay {
 public:
  Replay(const TransitionShape& shape, std::int64_t capacity) : shape_(shape), capacity_(capacity) {}

  const TransitionShape& shape() const { return shape_; }
  std::int64_t size() const { return size_; }

  void add(const Transition& transition);

  /// The row of a transition; 0 … size()-1 in no particular order.
  std::span<const float> row(std::int64_t index) const {
    return {rows_.data() + static_cast<std::size_t>(index) * shape_.width(), shape_.width()};
  }

  /// Draws rows uniformly with replacement: `to` takes their indices. Draws 0 … to.size()-1 of the stream.
  void sample(Rng rng, std::span<std::int64_t> to) const;

  /// Only what was filled is written; every number is kept to the bit.
  void save(Saver& saver) const;
  void load(Loader& loader);

 private:
  TransitionShape shape_;
  std::int64_t capacity_;
  std::int64_t size_ = 0;
  std::int64_t next_ = 0;  // where the next transition goes
  Buffer<float> rows_;
};

}  // namespace gust
