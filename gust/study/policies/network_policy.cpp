#include "gust/study/policies/network_policy.h"

#include <algorithm>
#include <vector>

#include "gust/nn/wide_mlp.h"

namespace gust {
namespace {

constexpr std::size_t kLanes = 64;  // that pass the network together

/// Components x lanes, some lanes of them, become lanes x components, each rounded to float32 on the way.
template <class T>
void by_lane(Rows<const double> from, std::size_t first, std::span<T> to) {
  for (std::size_t i = 0; i < from.rows; ++i) {
    for (std::size_t lane = 0; lane * from.rows < to.size(); ++lane) {
      to[lane * from.rows + i] = static_cast<float>(from.at(i, first + lane));
    }
  }
}

template <class T>
void by_component(std::span<const T> from, std::size_t first, Rows<double> to) {
  for (std::size_t i = 0; i < to.rows; ++i) {
    for (std::size_t lane = 0; lane * to.rows < from.size(); ++lane) {
      to.at(i, first + lane) = static_cast<double>(from[lane * to.rows + i]);
    }
  }
}

/// A chain of linear layers, and perhaps a box, computed in double: what is left is the rounding of the observation.
class ActorPolicy final : public Policy {
 public:
  explicit ActorPolicy(const ActorNetwork& actor)
      : mlp_(actor.mlp, kLanes), box_(actor.box), in_(kLanes * observations()), out_(kLanes * actions()) {}

  std::size_t observations() const override { return mlp_.inputs(); }
  std::size_t actions() const override { return mlp_.outputs(); }

  void act(Rows<const double> observation, std::span<const std::int64_t>, Rows<double> action) override {
    for (std::size_t lane = 0; lane < observation.lanes; lane += kLanes) {
      const std::size_t count = std::min(kLanes, observation.lanes - lane);
      const std::span<double> in(in_.data(), count * observations());
      by_lane(observation, lane, in);
      const std::span<double> out(out_.data(), count * actions());
      std::ranges::copy(mlp_.forward(in), out.begin());
      if (box_) squash(*box_, out);
      by_component<double>(out, lane, action);
    }
  }

 private:
  WideMlp mlp_;
  std::optional<ActionBox> box_;
  std::vector<double> in_, out_;  // lanes x components
};

/// Any other network, in float32.
class GraphPolicy final : public Policy {
 public:
  explicit GraphPolicy(OnnxModel model)
      : model_(std::move(model)), runner_(model_), in_(kLanes * observations()), out_(kLanes * actions()) {}
  GraphPolicy(const GraphPolicy&) = delete;  // the runner refers to the model
  GraphPolicy& operator=(const GraphPolicy&) = delete;

  std::size_t observations() const override { return model_.observations(); }
  std::size_t actions() const override { return model_.actions(); }

  void act(Rows<const double> observation, std::span<const std::int64_t>, Rows<double> action) override {
    for (std::size_t lane = 0; lane < observation.lanes; lane += kLanes) {
      const std::size_t count = std::min(kLanes, observation.lanes - lane);
      const std::span<float> in(in_.data(), count * observations());
      const std::span<float> out(out_.data(), count * actions());
      by_lane(observation, lane, in);
      runner_.run(in, count, out);
      by_component<float>(out, lane, action);
    }
  }

 private:
  OnnxModel model_;
  OnnxRunner runner_;
  std::vector<float> in_, out_;  // lanes x components
};

}  // namespace

std::unique_ptr<Policy> network_policy(OnnxModel model, Arithmetic arithmetic) {
  if (model.actor && arithmetic == Arithmetic::kDouble) return std::make_unique<ActorPolicy>(*model.actor);
  return std::make_unique<GraphPolicy>(std::move(model));
}

}  // namespace gust
