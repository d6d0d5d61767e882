#include "gust/agents/squashed_actor.h"

#include <algorithm>
#include <cmath>

#include "gust/core/error.h"
#include "gust/nn/initialise.h"
#include "gust/nn/squashed_gaussian.h"

namespace gust {
namespace {

Activation activation_of(const std::string& name) {
  return name == "tanh" ? Activation::kTanh : name == "relu" ? Activation::kRelu : Activation::kLeakyRelu;
}

MlpShape actor_shape(const OffPolicyOptions& options, std::size_t inputs, std::size_t actions) {
  MlpShape shape = off_policy_shape(options, inputs, 2 * actions);
  shape.linear_top = options.actor_trunk == "scg";
  return shape;
}

}  // namespace

ActionBox action_box(const PlantSpec& spec) {
  ActionBox box;
  for (std::size_t i = 0; i < spec.action.size(); ++i) {
    const double low = spec.normalized_action ? -1.0 : spec.action_low[i];
    const double high = spec.normalized_action ? 1.0 : spec.action_high[i];
    if (!std::isfinite(low) || !std::isfinite(high) || !(low < high))
      throw Error(cat("a squashed policy needs bounds of '", spec.action[i].name, "', got ", low, " to ", high));
    box.centre.push_back(static_cast<float>(0.5 * (low + high)));
    box.half_width.push_back(static_cast<float>(0.5 * (high - low)));
  }
  return box;
}

MlpShape off_policy_shape(const OffPolicyOptions& options, std::size_t inputs, std::size_t outputs) {
  MlpShape shape{.activation = activation_of(options.activation)};
  shape.sizes.assign(static_cast<std::size_t>(options.layers), static_cast<std::size_t>(options.hidden));
  shape.sizes.insert(shape.sizes.begin(), inputs);
  shape.sizes.push_back(outputs);
  return shape;
}

SquashedActor::SquashedActor(const OffPolicyOptions& options, std::size_t inputs, ActionBox box, Rng rng)
    : adam_{.rate = options.actor_rate, .epsilon = options.adam_epsilon},
      box_(std::move(box)),
      density_of_tanh_(options.density == "tanh"),
      rng_(rng),
      network_(actor_shape(options, inputs, box_.centre.size()), static_cast<std::size_t>(options.batch), {},
               TrainedMlp<float>::Target::kNo),
      stepping_(network_.mlp().shape(), static_cast<std::size_t>(options.environments)) {
  const auto lanes = static_cast<std::size_t>(options.batch);
  noise_ = Tiles<float>(lanes, actions());
  at_action_ = Tiles<float>(lanes, actions());
  at_heads_ = Tiles<float>(lanes, 2 * actions());
  log_density_.resize(noise_.count() * kTileLanes);
  at_log_density_.resize(kTileLanes);
  initialise_uniform(network_.mlp(), rng.split("actor"));
}

void SquashedActor::act(std::span<const float> input, std::uint64_t step, std::span<float> action) {
  const std::span<const float> heads = stepping_.forward(network_.mlp(), input);
  const Rng noise = rng_.split("policy");
  const std::size_t width = actions();
  for (std::size_t lane = 0; lane * width < action.size(); ++lane) {
    const Rng stream = noise.split(lane);
    for (std::size_t d = 0; d < width; ++d) {
      const float* head = &heads[lane * 2 * width];
      const double log_std = clip(static_cast<double>(head[width + d]), kLogStdLow, kLogStdHigh);
      const double u = head[d] + exp(log_std) * stream.normal(step * width + d);
      action[lane * width + d] = static_cast<float>(u);
    }
  }
  squash<float>(box_, action);
}

void SquashedActor::act_randomly(std::uint64_t step, std::span<float> action) const {
  const Rng noise = rng_.split("warm-up");
  const std::size_t width = actions();
  for (std::size_t i = 0; i < action.size(); ++i) {
    const double u = 2.0 * noise.split(i / width).uniform(step * width + i % width) - 1.0;
    action[i] = static_cast<float>(box_.centre[i % width] + box_.half_width[i % width] * u);
  }
}

SquashedGaussian<float> SquashedActor::policy(const Tiles<float>& heads, std::size_t tile) const {
  return {.mean = heads.features(tile, 0, actions()),
          .log_std = heads.features(tile, actions(), actions()),
          .centre = box_.centre,
          .half_width = box_.half_width,
          .of_tanh = density_of_tanh_};
}

void SquashedActor::propose(const Tiles<float>& input, Rng rng, std::size_t at, Tiles<float>& into) {
  heads_ = &network_.forward(input);
  for (std::size_t lane = 0; lane < input.lanes(); ++lane)
    for (std::size_t d = 0; d < actions(); ++d)
      noise_.at(lane, d) = static_cast<float>(rng.normal(lane * actions() + d));
  for (std::size_t tile = 0; tile < input.count(); ++tile) {
    const std::span density = std::span(log_density_).subspan(tile * kTileLanes, kTileLanes);
    squashed_sample<float>(policy(*heads_, tile), noise_.tile(tile), {into.features(tile, at, actions()), density});
  }
}

void SquashedActor::improve(const Tiles<float>& value_at_action, double temperature) {
  const std::size_t lanes = noise_.lanes();
  const auto share = static_cast<float>(1.0 / static_cast<double>(lanes));
  for (std::size_t tile = 0; tile < noise_.count(); ++tile) {
    const std::span<float> at_action = at_action_.tile(tile);
    const std::span<const float> slope =
        value_at_action.features(tile, value_at_action.features() - actions(), actions());
    std::ranges::transform(slope, at_action.begin(), [&](float value) { return -share * value; });
    for (std::size_t lane = 0; lane < kTileLanes; ++lane)
      at_log_density_[lane] = tile * kTileLanes + lane < lanes ? static_cast<float>(temperature) * share : 0.0f;
    squashed_gradient<float>(policy(*heads_, tile), noise_.tile(tile), {at_action, at_log_density_},
                             {at_heads_.features(tile, 0, actions()), at_heads_.features(tile, actions(), actions())});
  }
  network_.step(adam_, at_heads_);
}

ActorNetwork SquashedActor::network() const {
  const Mlp<float>& all = network_.mlp();
  MlpShape shape = all.shape();
  shape.sizes.back() = actions();
  Mlp<float> means(shape);
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    for (std::size_t output = 0; output < shape.sizes[layer + 1]; ++output) {
      means.bias(layer, output) = all.bias(layer, output);
      for (std::size_t input = 0; input < shape.sizes[layer]; ++input)
        means.weight(layer, output, input) = all.weight(layer, output, input);
    }
  }
  return {.mlp = without_linear_top(means), .box = box_};
}

}  // namespace gust
