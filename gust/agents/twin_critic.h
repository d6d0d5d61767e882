#pragma once

#include <array>

#include "gust/agents/critic.h"
#include "gust/agents/off_policy_options.h"
#include "gust/nn/trained_mlp.h"

namespace gust {

/// The two critics of soft actor-critic (docs/algorithms.md 2.2): the value of an action is the lesser of theirs. Both
/// learn, by the mean squared error, the target
///
///   y = reward + discount alive (min over the target networks of Q'(s', a') - temperature log pi(a'|s'))
class TwinCritic final : public Critic {
 public:
  TwinCritic(const OffPolicyOptions& options, const TransitionShape& shape, Rng rng);

  void judge(const Tiles<float>& input, Rng rng, Judgement judgement) override;
  double update(const UpdateBatch& update) override;
  bool finite() const override;
  void save(Saver& saver) const override;
  void load(Loader& loader) override;

  /// The value that one critic gives, per lane: an output of the network.
  const Tiles<float>& values(std::size_t critic, const Tiles<float>& input) { return critics_[critic].forward(input); }

 private:
  void set_targets(const UpdateBatch& update);

  double discount_;
  float polyak_;
  AdamOptions adam_;
  std::array<TrainedMlp<float>, 2> critics_;
  std::array<Tiles<float>, 2> at_value_;
  Buffer<float> target_;
};

}  // namespace gust
