#include "gust/agents/quantile_critic.h"

#include <algorithm>
#include <cmath>

#include "gust/agents/quantile_loss.h"
#include "gust/agents/squashed_actor.h"

namespace gust {
namespace {

QuantileShape shape_of(const RaacOptions& options, const TransitionShape& shape) {
  return {.inputs = shape.observations + shape.actions + shape.extras,
          .hidden = static_cast<std::size_t>(options.hidden),
          .layers = static_cast<std::size_t>(options.layers),
          .cosines = static_cast<std::size_t>(options.cosines),
          .head = static_cast<std::size_t>(options.head),
          .activation = off_policy_shape(options, 1, 1).activation};
}

QuantileRoom room_of(const RaacOptions& options, std::int64_t fractions) {
  return {static_cast<std::size_t>(options.batch), static_cast<std::size_t>(fractions), options.fraction_sets == "own"};
}

}  // namespace

TrainedQuantiles::TrainedQuantiles(const QuantileShape& shape, Rng rng) : network(shape) {
  initialise_uniform(network, rng);
  target = network;
  for (std::size_t part = 0; part < adam.size(); ++part)
    adam[part] = AdamState<float>(network.parameters()[part].size());
}

void TrainedQuantiles::step(const AdamOptions& options, const QuantileNetwork<float>& gradient, float share) {
  for (std::size_t part = 0; part < adam.size(); ++part) {
    const AdamStep<float> step(options, adam[part]);
    adam_move<float>(step,
                     {network.parameters()[part], gradient.parameters()[part], adam[part].first, adam[part].second},
                     {target.parameters()[part], share});
  }
}

bool TrainedQuantiles::finite() const {
  return std::ranges::all_of(network.parameters(), [](std::span<const float> part) {
    return std::ranges::all_of(part, [](float value) { return std::isfinite(value); });
  });
}

template <class Archive, class Self>
void TrainedQuantiles::archive(Archive& archive, Self& self) {
  for (std::size_t part = 0; part < self.adam.size(); ++part) {
    archive.block(self.network.parameters()[part]);
    archive.block(self.target.parameters()[part]);
    archive.block(std::span(self.adam[part].first));
    archive.block(std::span(self.adam[part].second));
    archive.number(self.adam[part].beta1_power);
    archive.number(self.adam[part].beta2_power);
  }
}

void QuantileCritic::DrawnFractions::draw(Rng rng, double end, bool stratified) {
  const std::size_t count = view().count();
  const auto at = [&](std::size_t lane, std::size_t i) {
    const double u = rng.uniform(lane * count + i);
    return static_cast<float>(end * (stratified ? (static_cast<double>(i) + u) / static_cast<double>(count) : u));
  };
  for (std::size_t i = 0; i < shared.size(); ++i) shared[i] = at(0, i);
  for (std::size_t lane = 0; lane < own.lanes(); ++lane)
    for (std::size_t i = 0; i < count; ++i) own.at(lane, i) = at(lane, i);
}

QuantileCritic::QuantileCritic(const RaacOptions& options, const TransitionShape& shape, Rng rng)
    : options_(options),
      adam_{.rate = options.critic_rate, .epsilon = options.adam_epsilon},
      gradient_(shape_of(options, shape)),
      update_runner_(shape_of(options, shape), room_of(options, options.fractions), 0, 0),
      target_runner_(shape_of(options, shape), room_of(options, options.target_fractions), 0, 0),
      at_judged_(static_cast<std::size_t>(options.batch), static_cast<std::size_t>(options.actor_fractions)),
      at_learned_(at_judged_.lanes(), static_cast<std::size_t>(options.fractions)),
      targets_(at_judged_.lanes(), static_cast<std::size_t>(options.target_fractions)) {
  for (std::int64_t critic = 0; critic < options.critics; ++critic) {
    critics_.emplace_back(shape_of(options, shape), rng.split(cat("critic ", critic + 1)));
    judging_.emplace_back(shape_of(options, shape), room_of(options, options.actor_fractions), shape.observations,
                          shape.actions);
  }
  for (Buffer<float>& risk : risk_) risk.assign(at_judged_.lanes(), std::numeric_limits<float>::infinity());
}

void QuantileCritic::judge(const Tiles<float>& input, Rng rng, Judgement judgement) {
  const std::size_t count = at_judged_.features();
  const double scale = (options_.raac_inv_alpha ? 1.0 / options_.alpha : 1.0) / static_cast<double>(count);
  for (std::size_t critic = 0; critic < critics_.size(); ++critic) {
    Runner& runner = judging_[critic];
    runner.fractions.draw(rng, options_.alpha, options_.stratified);
    const Tiles<float>& quantiles = runner.run.forward(critics_[critic].network, input, runner.fractions.view());
    for (std::size_t lane = 0; lane < input.lanes(); ++lane) {
      double sum = 0.0;
      for (std::size_t i = 0; i < count; ++i) sum += static_cast<double>(quantiles.at(lane, i));
      risk_[critic][lane] = static_cast<float>(scale * sum);
    }
  }
  for (std::size_t tile = 0; tile < input.count(); ++tile) std::ranges::fill(judgement.at_action.tile(tile), 0.0f);
  for (std::size_t critic = 0; critic < critics_.size(); ++critic) {
    for (std::size_t lane = 0; lane < input.lanes(); ++lane) {
      const std::size_t lesser = risk_[0][lane] <= risk_[1][lane] ? 0 : 1;
      judgement.value[lane] = risk_[lesser][lane];
      for (std::size_t i = 0; i < count; ++i)
        at_judged_.at(lane, i) = lesser == critic ? static_cast<float>(scale) : 0.0f;
    }
    const Tiles<float>& slope = judging_[critic].run.backward_to_input(critics_[critic].network, at_judged_);
    const std::size_t actions = judgement.at_action.features();
    for (std::size_t tile = 0; tile < input.count(); ++tile) {
      const std::span<float> to = judgement.at_action.tile(tile);
      std::ranges::transform(to, slope.features(tile, slope.features() - actions, actions), to.begin(), std::plus<>());
    }
  }
}

/// Draws of the returns that the critics should have; in double, for they may be a hundred times the rewards.
void QuantileCritic::set_targets(const UpdateBatch& update) {
  target_runner_.fractions.draw(update.rng.split("targets"), 1.0, false);
  for (std::size_t critic = 0; critic < critics_.size(); ++critic) {
    const Tiles<float>& next =
        target_runner_.run.forward(critics_[critic].target, update.batch.next_acted, target_runner_.fractions.view());
    for (std::size_t tile = 0; tile < next.count(); ++tile) {
      const std::span<float> to = targets_.tile(tile);
      critic == 0 ? void(std::ranges::copy(next.tile(tile), to.begin()))
                  : void(std::ranges::transform(to, next.tile(tile), to.begin(),
                                                [](float a, float b) { return std::min(a, b); }));
    }
  }
  for (std::size_t lane = 0; lane < targets_.lanes(); ++lane) {
    const double cost = update.temperature * update.next_log_density[lane];
    const double weight = options_.discount * update.batch.alive[lane];
    for (std::size_t j = 0; j < targets_.features(); ++j)
      targets_.at(lane, j) = static_cast<float>(update.batch.reward[lane] + weight * (targets_.at(lane, j) - cost));
  }
}

double QuantileCritic::update(const UpdateBatch& update) {
  set_targets(update);
  update_runner_.fractions.draw(update.rng.split("fractions"), 1.0, false);
  const Fractions<float> fractions = update_runner_.fractions.view();
  double loss = 0.0;
  for (TrainedQuantiles& critic : critics_) {
    const Tiles<float>& quantiles = update_runner_.run.forward(critic.network, update.batch.taken, fractions);
    loss += quantile_loss<float>({quantiles, fractions, targets_}, options_.kappa, at_learned_);
    update_runner_.run.backward(critic.network, at_learned_, gradient_);
    critic.step(adam_, gradient_, static_cast<float>(options_.polyak));
  }
  return loss;
}

bool QuantileCritic::finite() const { return std::ranges::all_of(critics_, &TrainedQuantiles::finite); }

void QuantileCritic::save(Saver& saver) const {
  for (const TrainedQuantiles& critic : critics_) TrainedQuantiles::archive(saver, critic);
}

void QuantileCritic::load(Loader& loader) {
  for (TrainedQuantiles& critic : critics_) TrainedQuantiles::archive(loader, critic);
}

}  // namespace gust
