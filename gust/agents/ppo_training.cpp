#include "gust/agents/ppo_training.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

PpoTraining::PpoTraining(const PpoOptions& options, const TrainingTask& task, const Kind& kind)
    : options_(options),
      task_(task),
      identity_(cat("gust ", kind.identity, " seed ", task.seed)),
      total_steps_((options.steps - 1) / (kind.rollouts * options.samples()) + 1),
      rng_(Rng(static_cast<std::uint64_t>(task.seed)).split("training")),
      collector_(options, task, kind.against, rng_.split("environments")),
      protagonist_(options, task.plant->spec().observations(), task.plant->spec().action.size(), rng_.split("learner")),
      rollout_(static_cast<std::size_t>(options.environments), static_cast<std::size_t>(options.rollout),
               task.plant->spec().observations(), task.plant->spec().action.size()),
      curve_(task, rng_.split("evaluation")) {
  total_steps_ *= kind.rollouts * options.samples();
}

void PpoTraining::advance() {
  if (done()) return;
  if (curve_.points().empty()) curve_.follow(*this, 0, false, 0);
  iterate(static_cast<double>(steps_) / static_cast<double>(total_steps_));
  if (!failure_.empty()) return;
  curve_.follow(*this, steps_, done(), protagonist_steps());
}

void PpoTraining::learn(PpoLearner& learner, Rollout& rollout, double progress) {
  learner.assess(rollout);
  if (!all_finite(rollout.value_target) || !all_finite(rollout.advantage)) return fail("returns are not finite");
  learner.update(rollout, progress);
  if (!learner.finite()) fail("the network's parameters are not finite");
}

ActorNetwork PpoTraining::as_seen(const Mlp<float>& mlp) const {
  const RunningMoments* scaling = collector_.scaling();
  return {scaling ? with_normaliser(mlp, *scaling) : mlp};
}

std::string PpoTraining::save() const {
  Saver saver;
  saver.text(identity_);
  archive(saver, *this);
  collector_.save(saver);
  save_more(saver);
  return saver.take();
}

void PpoTraining::load(std::string_view bytes) {
  Loader loader(bytes);
  std::string whose;
  loader.text(whose);
  if (whose != identity_) Loader::fail();
  archive(loader, *this);
  collector_.load(loader);
  load_more(loader);
  loader.finish();
}

}  // namespace gust
