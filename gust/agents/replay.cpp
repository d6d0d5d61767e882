#include "gust/agents/replay.h"

#include <algorithm>

namespace gust {

std::uint64_t replay_bytes(const TransitionShape& shape, std::int64_t capacity) {
  return static_cast<std::uint64_t>(capacity) * shape.width() * sizeof(float);
}

void Replay::add(const Transition& transition) {
  const std::size_t width = shape_.width();
  if (size_ < capacity_) {
    ++size_;
    rows_.resize(static_cast<std::size_t>(size_) * width);
  }
  float* row = rows_.data() + static_cast<std::size_t>(next_) * width;
  row = std::ranges::copy(transition.observation, row).out;
  row = std::ranges::copy(transition.action, row).out;
  row = std::ranges::copy(transition.extra, row).out;
  row = std::ranges::copy(transition.next, row).out;
  *row++ = transition.reward;
  *row = transition.terminated ? 0.0f : 1.0f;
  next_ = next_ + 1 == capacity_ ? 0 : next_ + 1;
}

void Replay::sample(Rng rng, std::span<std::int64_t> to) const {
  GUST_CHECK(size_ > 0);
  for (std::size_t i = 0; i < to.size(); ++i)
    to[i] = static_cast<std::int64_t>(rng.below(static_cast<std::uint64_t>(size_), i));
}

void Replay::save(Saver& saver) const {
  saver.number(size_);
  saver.number(next_);
  saver.block(std::span(rows_));
}

void Replay::load(Loader& loader) {
  std::int64_t size = 0;
  std::int64_t next = 0;
  loader.number(size);
  loader.number(next);
  const bool full = size == capacity_;
  if (size < 0 || size > capacity_ || next < 0 || (full ? next >= capacity_ : next != size)) Loader::fail();
  loader.rows(rows_, static_cast<std::size_t>(size), shape_.width());
  size_ = size;
  next_ = next;
}

}  // namespace gust
