#pragma once

#include <array>

#include "gust/agents/critic.h"
#include "gust/agents/wcpg_options.h"
#include "gust/nn/trained_mlp.h"

namespace gust {

/// The two critics of WCPG (docs/algorithms.md 4): each says that returns are N(Q, s^2), and a state with an action is
/// worth the lesser of their conditional values at risk Q - c(alpha) s, alpha being the last input. Targets take mean
/// and variance of the target network whose value is lesser.
class GaussianCritic final : public Critic {
 public:
  GaussianCritic(const WcpgOptions& options, const TransitionShape& shape, Rng rng);

  void judge(const Tiles<float>& input, Rng rng, Judgement judgement) override;
  double update(const UpdateBatch& update) override;
  bool finite() const override;
  void save(Saver& saver) const override;
  void load(Loader& loader) override;

  /// What one critic says of each lane.
  std::vector<ReturnLaw> laws(std::size_t critic, const Tiles<float>& input);

 private:
  double coefficient(const Tiles<float>& input, std::size_t lane) const;
  void set_targets(const UpdateBatch& update);

  ReturnLossOptions loss_;
  CvarForm form_;
  float polyak_;
  AdamOptions adam_;
  std::array<TrainedMlp<float>, 2> critics_;
  std::array<Tiles<float>, 2> at_outputs_;
  std::vector<ReturnSample> samples_;
};

}  // namespace gust
