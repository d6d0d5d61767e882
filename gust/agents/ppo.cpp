#include <algorithm>
#include <cmath>

#include "gust/agents/archive.h"
#include "gust/agents/environments.h"
#include "gust/agents/lanes.h"
#include "gust/agents/learning_curve.h"
#include "gust/agents/ppo_learner.h"
#include "gust/nn/normaliser.h"

namespace gust {
namespace {

/// A network that takes the place of `mlp` behind (x - mean) / sqrt(variance + 1e-8): its first layer does both. The
/// normaliser's clip at ±10 is left out.
Mlp<float> with_normaliser(const Mlp<float>& mlp, const RunningMoments& moments) {
  Mlp<float> result = mlp;
  for (std::size_t output = 0; output < mlp.shape().sizes[1]; ++output) {
    double bias = mlp.bias(0, output);
    for (std::size_t input = 0; input < mlp.shape().inputs(); ++input) {
      const double weight = mlp.weight(0, output, input) / std::sqrt(moments.variance[input] + 1e-8);
      bias -= weight * moments.mean[input];
      result.weight(0, output, input) = static_cast<float>(weight);
    }
    result.bias(0, output) = static_cast<float>(bias);
  }
  return result;
}

bool all_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

class PpoTraining final : public Training {
 public:
  PpoTraining(const PpoOptions& options, const TrainingTask& task)
      : PpoTraining(options, task, Rng(static_cast<std::uint64_t>(task.seed)).split("training")) {}

  void advance() override;
  bool done() const override { return steps_ >= total_steps() || !failure_.empty(); }
  std::int64_t steps() const override { return steps_; }
  std::int64_t total_steps() const override;
  const std::string& failure() const override { return failure_; }
  const std::vector<CurvePoint>& curve() const override { return curve_.points(); }
  ActorNetwork actor() const override;
  std::string save() const override;
  void load(std::string_view bytes) override;

 private:
  PpoTraining(const PpoOptions& options, const TrainingTask& task, Rng rng);

  void collect();
  void observe();
  void see();
  void keep_truncated(std::size_t sample);
  std::string identity() const { return cat("gust ppo 1 ", canonical_fields(options_), " seed ", seed_); }

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    PpoLearner::archive(archive, self.learner_);
    for (auto* moments : {&self.observation_moments_, &self.reward_scale_.moments}) {
      archive.block(std::span(moments->mean));
      archive.block(std::span(moments->variance));
      archive.number(moments->count);
    }
    archive.block(std::span(self.reward_scale_.discounted));
    archive.number(self.steps_);
    archive.text(self.failure_);
    LearningCurve::archive(archive, self.curve_);
  }

  PpoOptions options_;
  std::int64_t seed_;
  Environments environments_;
  PpoLearner learner_;
  Rollout rollout_;
  LearningCurve curve_;
  RunningMoments observation_moments_;
  RewardScale reward_scale_;
  Matrix<double> observation_;  // as the networks see it
  Matrix<double> command_;
  std::vector<double> reward_;
  std::int64_t steps_ = 0;
  std::string failure_;
};

PpoTraining::PpoTraining(const PpoOptions& options, const TrainingTask& task, Rng rng)
    : options_(options),
      seed_(task.seed),
      environments_(task, static_cast<std::size_t>(options.environments), rng.split("environments")),
      learner_(options, task.plant->spec().observations(), task.plant->spec().action.size(), rng.split("learner")),
      rollout_(environments_.count(), static_cast<std::size_t>(options.rollout), task.plant->spec().observations(),
               task.plant->spec().action.size()),
      curve_(task, rng.split("evaluation")),
      observation_moments_(rollout_.observations),
      reward_scale_(environments_.count()),
      observation_(rollout_.observations, environments_.count()),
      command_(rollout_.actions, environments_.count()),
      reward_(environments_.count()) {
  observe();
}

ActorNetwork PpoTraining::actor() const {
  const bool scaled = options_.normalise_observation;
  return {scaled ? with_normaliser(learner_.actor(), observation_moments_) : learner_.actor()};
}

std::int64_t PpoTraining::total_steps() const {
  const std::int64_t batch = options_.samples();
  return (options_.steps + batch - 1) / batch * batch;
}

void PpoTraining::advance() {
  if (done()) return;
  if (curve_.points().empty()) curve_.follow(*this, 0, false);
  const double progress = static_cast<double>(steps_) / static_cast<double>(total_steps());
  collect();
  learner_.assess(rollout_);
  steps_ += options_.samples();
  if (!all_finite(rollout_.value_target) || !all_finite(rollout_.advantage)) {
    failure_ = cat("returns are no finite numbers after ", steps_, " steps");
    return;
  }
  learner_.update(rollout_, progress);
  if (!learner_.finite()) {
    failure_ = cat("the network's parameters are no finite numbers after ", steps_, " steps");
    return;
  }
  curve_.follow(*this, steps_, done());
}

/// One rollout with the stochastic policy; the environments go on where they stood.
void PpoTraining::collect() {
  rollout_.truncated.clear();
  rollout_.terminal_observation.clear();
  for (std::size_t step = 0; step < rollout_.steps; ++step) {
    const std::size_t first = step * rollout_.environments;
    to_lanes(observation_.view(), rollout_.observation_at(first));
    learner_.sample(rollout_, first, static_cast<std::uint64_t>(steps_ / options_.environments) + step);
    to_rows(rollout_.action_at(first), command_.view());
    environments_.step(command_.view());
    std::ranges::copy(environments_.reward(), reward_.begin());
    if (options_.normalise_reward) scale_rewards(reward_scale_, options_.discount, environments_.done(), reward_);
    std::ranges::copy(reward_, rollout_.reward.begin() + static_cast<std::ptrdiff_t>(first));
    std::ranges::copy(environments_.done(), rollout_.done.begin() + static_cast<std::ptrdiff_t>(first));
    keep_truncated(first);
    observe();
  }
  to_lanes(observation_.view(), rollout_.last_observation);
}

/// Takes in what the environments show now.
void PpoTraining::observe() {
  if (options_.normalise_observation) update_moments(observation_moments_, environments_.observation());
  see();
}

/// What the networks see of the environments.
void PpoTraining::see() {
  const Rows<const double> shown = environments_.observation();
  if (options_.normalise_observation) return normalise(observation_moments_, shown, observation_.view());
  for (std::size_t i = 0; i < shown.rows; ++i) std::ranges::copy(shown.row(i), observation_.row(i).begin());
}

/// Remembers the last observations of episodes that time alone ended, as the networks see them.
void PpoTraining::keep_truncated(std::size_t sample) {
  for (std::size_t lane = 0; lane < rollout_.environments; ++lane) {
    if (!environments_.truncated()[lane]) continue;
    Matrix<double> seen(rollout_.observations, 1);
    for (std::size_t i = 0; i < seen.rows(); ++i) seen.at(i, 0) = environments_.terminal_observation().at(i, lane);
    if (options_.normalise_observation) normalise(observation_moments_, seen.view(), seen.view());
    for (std::size_t i = 0; i < seen.rows(); ++i)
      rollout_.terminal_observation.push_back(static_cast<float>(seen.at(i, 0)));
    rollout_.truncated.push_back(sample + lane);
  }
}

std::string PpoTraining::save() const {
  Saver saver;
  saver.text(identity());
  archive(saver, *this);
  environments_.save(saver);
  return saver.take();
}

void PpoTraining::load(std::string_view bytes) {
  Loader loader(bytes);
  std::string whose;
  loader.text(whose);
  if (whose != identity()) Loader::fail();
  archive(loader, *this);
  environments_.load(loader);
  loader.finish();
  see();
}

class Ppo final : public Agent {
 public:
  explicit Ppo(const PpoOptions& options) : options_(options) {}
  std::int64_t steps() const override { return options_.steps; }
  std::unique_ptr<Training> start(const TrainingTask& task) const override {
    return std::make_unique<PpoTraining>(options_, task);
  }

 private:
  PpoOptions options_;
};

}  // namespace

Entry<Agent> agent_ppo() {
  return make_entry<Agent, PpoOptions>(
      "ppo", "Proximal policy optimisation: a stochastic actor and a critic that learn from clipped steps.",
      "Schulman et al. 2017; safe-control-gym's PPO (spec: algorithms 1)",
      [](const PpoOptions& options) { return std::make_unique<Ppo>(options); });
}

}  // namespace gust
