#pragma once

#include "gust/agents/ppo_learner.h"

namespace gust {

/// Adversaries that share some environments: each environment has one of them, its owner, drawn uniformly with
/// replacement. Each learns from the samples that it owned (docs/algorithms.md 3.3).
class Population {
 public:
  struct Options {
    std::int64_t size = 2;
    std::int64_t strength_bins = 1;  ///< adversary k reaches (k mod bins + 1) / bins of the scale
    bool joint_advantages = false;   ///< advantages are standardised over all adversaries' samples together
  };

  /// Adversaries that learn with `options` and act on `channels` channels of a site, beside a protagonist's rollouts.
  Population(const PpoOptions& options, const Options& shared, const Rollout& shape, Rng rng);

  /// Draws a new owner for each environment that is marked; each environment has a stream of its own.
  void draw(std::span<const std::uint8_t> marked);

  /// The owner of each environment now.
  std::span<const std::size_t> owners() const { return owners_; }
  const std::vector<PpoLearner>& learners() const { return learners_; }
  /// The share of the scale that an adversary reaches.
  double strength(std::size_t adversary) const;

  /// The owners' actions on the rollout's samples from `first` on, draws number `step`; environments x channels.
  std::span<const float> act(const Rollout& rollout, std::size_t first, std::uint64_t step);

  /// Lets every adversary learn from its own samples of a whole rollout, with the protagonist's rewards negated. False
  /// if numbers are not finite.
  bool learn(const Rollout& rollout, double progress);

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    for (auto& learner : self.learners_) PpoLearner::archive(archive, learner);
    archive.block(std::span(self.owners_));
    archive.block(std::span(self.draws_));
  }

 private:
  void standardise_advantages();

  PpoOptions options_;
  Options shared_;
  Rng rng_;
  std::vector<PpoLearner> learners_;
  std::vector<Rollout> rollouts_;                // of each learner: all samples, of which it owns some
  std::vector<std::vector<std::uint32_t>> own_;  // of each learner: its samples of the rollout at hand
  std::vector<std::size_t> owners_;              // of each environment
  std::vector<std::uint64_t> draws_;             // of each environment, so far
  Buffer<float> action_;                         // environments x channels
};

}  // namespace gust
