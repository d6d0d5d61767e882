#include "gust/agents/off_policy_training.h"

#include <algorithm>

#include "gust/agents/lanes.h"

namespace gust {
namespace {

TransitionShape shape_of(const PlantSpec& spec, bool risk) {
  return {.observations = spec.observations(), .actions = spec.action.size(), .extras = risk ? 1u : 0u};
}

}  // namespace

std::uint64_t replay_bytes(const OffPolicyOptions& options, const PlantSpec& spec, bool risk) {
  return replay_bytes(shape_of(spec, risk), std::min(options.buffer, options.total_steps()));
}

OffPolicyTraining::OffPolicyTraining(OffPolicySetup setup, const TrainingTask& task)
    : OffPolicyTraining(std::move(setup), task, Rng(static_cast<std::uint64_t>(task.seed)).split("training")) {}

OffPolicyTraining::OffPolicyTraining(OffPolicySetup setup, const TrainingTask& task, Rng rng)
    : setup_(std::move(setup)),
      seed_(task.seed),
      rng_(rng),
      environments_(task, static_cast<std::size_t>(setup_.options.environments), rng.split("environments")),
      shape_(shape_of(task.plant->spec(), setup_.risk.has_value())),
      learner_(setup_.options, shape_, action_box(task.plant->spec()), setup_.make_critic, rng.split("learner")),
      replay_(shape_, setup_.options.buffer),
      curve_(task, rng.split("evaluation")),
      level_(environments_.count()),
      episodes_(environments_.count()),
      seen_(environments_.count() * (shape_.observations + shape_.extras)),
      action_(environments_.count() * shape_.actions),
      next_(shape_.observations),
      command_(shape_.actions, environments_.count()) {
  learner_.prepare(setup_.prepare);
  for (std::size_t lane = 0; lane < environments_.count(); ++lane) draw_level(lane);
}

ActorNetwork OffPolicyTraining::actor() const {
  ActorNetwork network = learner_.actor().network();
  if (setup_.risk) network.alpha = static_cast<float>(setup_.risk->acts_at);
  return network;
}

void OffPolicyTraining::advance() {
  constexpr int kMostSteps = 1000;  // without updates: the caller wants to hear of progress
  if (done()) return;
  if (curve_.points().empty()) curve_.follow(*this, 0, false);
  for (int k = 0; k < kMostSteps && !done() && owed_ < static_cast<double>(setup_.options.burst); ++k) step();
  pay_updates();
  if (!learner_.finite()) {
    failure_ = cat("the networks' parameters are not finite after ", steps_, " steps");
    return;
  }
  curve_.follow(*this, steps_, done());
}

/// One step of all environments, by chance at first.
void OffPolicyTraining::step() {
  see();
  const std::int64_t environments = setup_.options.environments;
  const auto number = static_cast<std::uint64_t>(steps_ / environments);
  if (steps_ < setup_.options.warm_up) {
    learner_.actor().act_randomly(number, action_);
  } else {
    learner_.actor().act(seen_, number, action_);
  }
  to_rows(action_, command_.view());
  environments_.step(command_.view());
  remember();
  steps_ += environments;
  if (steps_ > setup_.options.warm_up) owed_ += setup_.options.update_ratio * static_cast<double>(environments);
}

/// What the actor sees of each environment: its observation, and its risk level.
void OffPolicyTraining::see() {
  const Rows<const double> shown = environments_.observation();
  float* to = seen_.data();
  for (std::size_t lane = 0; lane < shown.lanes; ++lane) {
    for (std::size_t i = 0; i < shown.rows; ++i) *to++ = static_cast<float>(shown.at(i, lane));
    if (setup_.risk) *to++ = static_cast<float>(level_[lane]);
  }
}

/// Keeps the transitions of the last step. Those that end an episode have its own last observation, not the next one's
/// first.
void OffPolicyTraining::remember() {
  const std::size_t inputs = shape_.observations + shape_.extras;
  for (std::size_t lane = 0; lane < environments_.count(); ++lane) {
    const bool over = environments_.done()[lane] != 0;
    const Rows<const double> next = over ? environments_.terminal_observation() : environments_.observation();
    for (std::size_t i = 0; i < next_.size(); ++i) next_[i] = static_cast<float>(next.at(i, lane));
    const std::span<const float> seen = std::span(seen_).subspan(lane * inputs, inputs);
    replay_.add({.observation = seen.first(shape_.observations),
                 .action = std::span(action_).subspan(lane * shape_.actions, shape_.actions),
                 .extra = seen.last(shape_.extras),
                 .next = next_,
                 .reward = static_cast<float>(environments_.reward()[lane]),
                 .terminated = over && environments_.truncated()[lane] == 0});
    if (over) draw_level(lane);
  }
}

void OffPolicyTraining::draw_level(std::size_t lane) {
  if (!setup_.risk) return;
  const double share = rng_.split("alpha").split(lane).uniform(episodes_[lane]++);
  level_[lane] = setup_.risk->low + share * (setup_.risk->high - setup_.risk->low);
}

void OffPolicyTraining::pay_updates() {
  const auto burst = static_cast<double>(setup_.options.burst);
  for (; owed_ >= burst && learner_.finite(); owed_ -= burst)
    for (std::int64_t i = 0; i < setup_.options.burst; ++i) learner_.update(replay_);
}

std::string OffPolicyTraining::save() const {
  Saver saver;
  saver.text(identity());
  archive(saver, *this);
  learner_.save(saver);
  environments_.save(saver);
  replay_.save(saver);
  return saver.take();
}

void OffPolicyTraining::load(std::string_view bytes) {
  Loader loader(bytes);
  std::string whose;
  loader.text(whose);
  if (whose != identity()) Loader::fail();
  archive(loader, *this);
  learner_.load(loader);
  environments_.load(loader);
  replay_.load(loader);
  loader.finish();
}

}  // namespace gust
