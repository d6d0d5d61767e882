#pragma once

#include <functional>
#include <memory>

#include "gust/agents/critic.h"
#include "gust/agents/squashed_actor.h"
#include "gust/agents/temperature.h"

namespace gust {

/// Builds the critics of a learner, from the stream that their first parameters are drawn from.
using MakeCritic = std::function<std::unique_ptr<Critic>(const OffPolicyOptions&, const TransitionShape&, Rng)>;

/// Soft actor-critic around any critics (docs/algorithms.md 2.2): a stochastic actor, a temperature, and one update
/// that teaches both and the critics from a minibatch of the memory. What it learns from, and when, is the training's
/// business.
class OffPolicyLearner {
 public:
  OffPolicyLearner(const OffPolicyOptions& options, const TransitionShape& shape, const ActionBox& box,
                   const MakeCritic& make_critic, Rng rng);

  SquashedActor& actor() { return actor_; }
  const SquashedActor& actor() const { return actor_; }
  Critic& critic() { return *critic_; }
  const Temperature& temperature() const { return temperature_; }
  std::int64_t updates() const { return updates_; }
  bool finite() const { return actor_.finite() && critic_->finite(); }

  /// What is done to a minibatch before it is learned from: given it and this update's own stream.
  void prepare(std::function<void(Minibatch&, Rng)> prepare) { prepare_ = std::move(prepare); }

  /// One update of everything, on transitions drawn from a memory that is not empty.
  void update(const Replay& replay);

  void save(Saver& saver) const;
  void load(Loader& loader);

 private:
  void improve_actor(Rng rng);
  void move_temperature() { temperature_.update(actor_.log_density().first(batch_.lanes())); }
  void teach_critics(Rng rng);

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    SquashedActor::archive(archive, self.actor_);
    Temperature::archive(archive, self.temperature_);
    archive.number(self.updates_);
  }

  bool critics_first_;
  Rng rng_;
  SquashedActor actor_;
  Temperature temperature_;
  std::unique_ptr<Critic> critic_;
  std::function<void(Minibatch&, Rng)> prepare_;
  std::int64_t updates_ = 0;

  // Of the update at hand.
  std::vector<std::int64_t> rows_;
  Minibatch batch_;
  Buffer<float> value_;
  Tiles<float> at_action_;
};

}  // namespace gust
