#include "gust/agents/population.h"

#include <algorithm>
#include <cmath>

namespace gust {
namespace {

/// Numbers of some samples, to be standardised together.
void gather(const std::vector<double>& from, std::span<const std::uint32_t> samples, std::vector<double>& to) {
  for (const std::uint32_t sample : samples) to.push_back(from[sample]);
}

void scatter(std::span<const double> from, std::span<const std::uint32_t> samples, std::vector<double>& to) {
  for (std::size_t i = 0; i < samples.size(); ++i) to[samples[i]] = from[i];
}

bool finite_at(const std::vector<double>& values, std::span<const std::uint32_t> samples) {
  return std::ranges::all_of(samples, [&](std::uint32_t sample) { return std::isfinite(values[sample]); });
}

}  // namespace

Population::Population(const PpoOptions& options, const Options& shared, const Rollout& shape, Rng rng)
    : options_(options),
      shared_(shared),
      rng_(rng),
      own_(static_cast<std::size_t>(shared.size)),
      owners_(shape.environments),
      draws_(shape.environments),
      action_(shape.environments * shape.actions) {
  for (std::size_t k = 0; k < own_.size(); ++k) {
    learners_.emplace_back(options, shape.observations, shape.actions, rng.split("adversary").split(k));
    rollouts_.push_back(shape);
  }
  draw(std::vector<std::uint8_t>(shape.environments, 1));
}

double Population::strength(std::size_t adversary) const {
  const auto bins = static_cast<std::size_t>(shared_.strength_bins);
  return static_cast<double>(adversary % bins + 1) / static_cast<double>(bins);
}

void Population::draw(std::span<const std::uint8_t> marked) {
  for (std::size_t i = 0; i < owners_.size(); ++i) {
    if (marked[i]) owners_[i] = rng_.split("owner").split(i).below(learners_.size(), draws_[i]++);
  }
}

std::span<const float> Population::act(const Rollout& rollout, std::size_t first, std::uint64_t step) {
  const std::size_t channels = action_.size() / owners_.size();
  const auto seen =
      std::span(rollout.observation).subspan(first * rollout.observations, rollout.environments * rollout.observations);
  for (std::size_t k = 0; k < learners_.size(); ++k) {
    if (first == 0) own_[k].clear();
    std::ranges::copy(seen, rollouts_[k].observation_at(first).begin());
    learners_[k].sample(rollouts_[k], first, step);
  }
  for (std::size_t i = 0; i < owners_.size(); ++i) {
    own_[owners_[i]].push_back(static_cast<std::uint32_t>(first + i));
    const auto drawn = rollouts_[owners_[i]].action_at(first).subspan(i * channels, channels);
    const auto reach = static_cast<float>(strength(owners_[i]));
    std::ranges::transform(drawn, action_.begin() + static_cast<std::ptrdiff_t>(i * channels),
                           [&](float v) { return reach * std::clamp(v, -1.0f, 1.0f); });
  }
  return action_;
}

bool Population::learn(const Rollout& rollout, double progress) {
  for (std::size_t k = 0; k < learners_.size(); ++k) {
    oppose(rollout, rollouts_[k]);
    learners_[k].evaluate(rollouts_[k]);
    if (!finite_at(rollouts_[k].advantage, own_[k]) || !finite_at(rollouts_[k].value_target, own_[k])) return false;
  }
  if (options_.advantage_scale == "rollout") standardise_advantages();
  for (std::size_t k = 0; k < learners_.size(); ++k) {
    learners_[k].update(rollouts_[k], own_[k], progress);
    if (!learners_[k].finite()) return false;
  }
  return true;
}

void Population::standardise_advantages() {
  std::vector<double> together;
  for (std::size_t k = 0; k < learners_.size(); ++k) {
    gather(rollouts_[k].advantage, own_[k], together);
    if (shared_.joint_advantages) continue;
    standardise(together);
    scatter(together, own_[k], rollouts_[k].advantage);
    together.clear();
  }
  if (!shared_.joint_advantages) return;
  standardise(together);
  std::span<const double> left(together);
  for (std::size_t k = 0; k < learners_.size(); ++k) {
    scatter(left, own_[k], rollouts_[k].advantage);
    left = left.subspan(own_[k].size());
  }
}

}  // namespace gust
