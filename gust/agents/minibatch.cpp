#include "gust/agents/minibatch.h"

namespace gust {

Minibatch::Minibatch(const TransitionShape& transition, std::size_t lanes)
    : shape(transition),
      observation(lanes, shape.observations + shape.extras),
      next(lanes, shape.observations + shape.extras),
      taken(lanes, shape.observations + shape.actions + shape.extras),
      acted(lanes, taken.features()),
      next_acted(lanes, taken.features()),
      reward(lanes),
      alive(lanes) {}

void Minibatch::gather(const Replay& replay, std::span<const std::int64_t> rows) {
  for (std::size_t lane = 0; lane < rows.size(); ++lane) {
    const std::span<const float> row = replay.row(rows[lane]);
    for (std::size_t i = 0; i < shape.observations; ++i) {
      observation.at(lane, i) = taken.at(lane, i) = acted.at(lane, i) = row[i];
      next.at(lane, i) = next_acted.at(lane, i) = row[shape.next_at() + i];
    }
    for (std::size_t i = 0; i < shape.actions; ++i) taken.at(lane, shape.observations + i) = row[shape.action_at() + i];
    for (std::size_t i = 0; i < shape.extras; ++i) set_extra(lane, i, row[shape.extra_at() + i]);
    reward[lane] = row[shape.reward_at()];
    alive[lane] = row[shape.alive_at()];
  }
}

void Minibatch::set_extra(std::size_t lane, std::size_t index, float value) {
  for (Tiles<float>* seen : {&observation, &next}) seen->at(lane, shape.observations + index) = value;
  for (Tiles<float>* judged : {&taken, &acted, &next_acted})
    judged->at(lane, shape.observations + shape.actions + index) = value;
}

}  // namespace gust
