#include "gust/agents/collector.h"

#include <algorithm>

#include "gust/agents/lanes.h"

namespace gust {

Collector::Collector(const PpoOptions& options, const TrainingTask& task, const std::optional<AdversarySite>& against,
                     Rng rng)
    : options_(options),
      environments_(task, static_cast<std::size_t>(options.environments), rng, against),
      observation_moments_(task.plant->spec().observations()),
      reward_scale_(environments_.count()),
      observation_(task.plant->spec().observations(), environments_.count()),
      command_(task.plant->spec().action.size(), environments_.count()),
      against_(environments_.channels(), environments_.count()),
      reward_(environments_.count()) {
  observe();
}

void Collector::collect(Rollout& rollout, const Play& play) {
  rollout.truncated.clear();
  rollout.terminal_observation.clear();
  for (std::size_t step = 0; step < rollout.steps; ++step) {
    const std::size_t first = step * rollout.environments;
    to_lanes(observation_.view(), rollout.observation_at(first));
    const std::span<const float> against = play(first);
    to_rows(rollout.action_at(first), command_.view());
    to_rows(against, against_.view());
    environments_.step(command_.view(), against_.view());
    std::ranges::copy(environments_.reward(), reward_.begin());
    if (options_.normalise_reward) scale_rewards(reward_scale_, options_.discount, environments_.done(), reward_);
    std::ranges::copy(reward_, rollout.reward.begin() + static_cast<std::ptrdiff_t>(first));
    std::ranges::copy(environments_.done(), rollout.done.begin() + static_cast<std::ptrdiff_t>(first));
    keep_truncated(rollout, first);
    observe();
  }
  to_lanes(observation_.view(), rollout.last_observation);
}

void Collector::restart() {
  environments_.restart();
  std::ranges::fill(reward_scale_.discounted, 0.0);
  observe();
}

/// Takes in what the environments show now.
void Collector::observe() {
  if (options_.normalise_observation) update_moments(observation_moments_, environments_.observation());
  see();
}

/// What the networks see of the environments.
void Collector::see() {
  const Rows<const double> shown = environments_.observation();
  if (options_.normalise_observation) return normalise(observation_moments_, shown, observation_.view());
  for (std::size_t i = 0; i < shown.rows; ++i) std::ranges::copy(shown.row(i), observation_.row(i).begin());
}

/// Remembers the last observations of episodes that time alone ended, as the networks see them.
void Collector::keep_truncated(Rollout& rollout, std::size_t first) {
  for (std::size_t lane = 0; lane < rollout.environments; ++lane) {
    if (!environments_.truncated()[lane]) continue;
    Matrix<double> seen(rollout.observations, 1);
    for (std::size_t i = 0; i < seen.rows(); ++i) seen.at(i, 0) = environments_.terminal_observation().at(i, lane);
    if (options_.normalise_observation) normalise(observation_moments_, seen.view(), seen.view());
    for (std::size_t i = 0; i < seen.rows(); ++i)
      rollout.terminal_observation.push_back(static_cast<float>(seen.at(i, 0)));
    rollout.truncated.push_back(first + lane);
  }
}

void Collector::save(Saver& saver) const {
  archive(saver, *this);
  environments_.save(saver);
}

void Collector::load(Loader& loader) {
  archive(loader, *this);
  environments_.load(loader);
  see();
}

}  // namespace gust
