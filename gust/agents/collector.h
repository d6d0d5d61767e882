#pragma once

#include <functional>

#include "gust/agents/environments.h"
#include "gust/agents/ppo_options.h"
#include "gust/nn/normaliser.h"

namespace gust {

/// Plays environments into rollouts as the networks see them: observations and rewards pass the running normalisers,
/// if those are on.
class Collector {
 public:
  /// `against` is where an adversary acts, if there is one.
  Collector(const PpoOptions& options, const TrainingTask& task, const std::optional<AdversarySite>& against, Rng rng);

  /// Draws the actions of the rollout's samples from `first` on, one an environment, given their observations; returns
  /// those of an adversary, environments x channels, or nothing.
  using Play = std::function<std::span<const float>(std::size_t first)>;

  /// Fills a rollout, but for what a learner fills in. The environments go on where they stood.
  void collect(Rollout& rollout, const Play& play);

  /// Begins a new episode in every environment.
  void restart();

  const Environments& environments() const { return environments_; }
  /// What observations are scaled by; none if they are not.
  const RunningMoments* scaling() const { return options_.normalise_observation ? &observation_moments_ : nullptr; }

  void save(Saver& saver) const;
  void load(Loader& loader);

 private:
  void observe();
  void see();
  void keep_truncated(Rollout& rollout, std::size_t first);

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    for (auto* moments : {&self.observation_moments_, &self.reward_scale_.moments}) {
      archive.block(std::span(moments->mean));
      archive.block(std::span(moments->variance));
      archive.number(moments->count);
    }
    archive.block(std::span(self.reward_scale_.discounted));
  }

  PpoOptions options_;
  Environments environments_;
  RunningMoments observation_moments_;
  RewardScale reward_scale_;
  Matrix<double> observation_;  // as the networks see it
  Matrix<double> command_;
  Matrix<double> against_;  // what an adversary does
  std::vector<double> reward_;
};

}  // namespace gust
