#pragma once

#include <vector>

#include "gust/agents/critic.h"
#include "gust/agents/raac_options.h"
#include "gust/nn/adam.h"
#include "gust/nn/quantile_network.h"

namespace gust {

/// A quantile network with its optimiser and the target network that follows it.
struct TrainedQuantiles {
  TrainedQuantiles(const QuantileShape& shape, Rng rng);

  /// One step of Adam along `gradient`, and one of the copy.
  void step(const AdamOptions& options, const QuantileNetwork<float>& gradient, float share);
  bool finite() const;

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self);

  QuantileNetwork<float> network;
  QuantileNetwork<float> target;
  std::array<AdamState<float>, 3> adam;  ///< of the network's parts
};

/// The critics of RAAC (docs/algorithms.md 5): each gives the quantiles of the return, and a state with an action is
/// worth the mean of the lowest, at fractions drawn from U(0, alpha); of two critics, the lesser. They learn by the
/// quantile Huber loss
///
///   y_j = reward + discount alive (min over the target networks of Z'(s', a'; tau'_j) - temperature log pi(a'|s'))
class QuantileCritic final : public Critic {
 public:
  QuantileCritic(const RaacOptions& options, const TransitionShape& shape, Rng rng);

  void judge(const Tiles<float>& input, Rng rng, Judgement judgement) override;
  double update(const UpdateBatch& update) override;
  bool finite() const override;
  void save(Saver& saver) const override;
  void load(Loader& loader) override;

  const QuantileNetwork<float>& network(std::size_t critic) const { return critics_[critic].network; }

 private:
  /// A set of fractions for each minibatch, shared or each lane's own.
  struct DrawnFractions {
    DrawnFractions(const QuantileRoom& room) : own(room.own ? room.lanes : 0, room.own ? room.fractions : 0) {
      shared.resize(room.own ? 0 : room.fractions);
    }
    /// Uniform in 0 … end; spread evenly if stratified.
    void draw(Rng rng, double end, bool stratified);
    Fractions<float> view() const { return {.shared = shared, .own = shared.empty() ? &own : nullptr}; }

    Buffer<float> shared;
    Tiles<float> own;
  };
  struct Runner {
    Runner(const QuantileShape& shape, const QuantileRoom& room, std::size_t first, std::size_t count)
        : run(shape, room, {.first = first, .count = count}), fractions(room) {}
    QuantileRunner<float> run;
    DrawnFractions fractions;
  };

  void set_targets(const UpdateBatch& update);

  RaacOptions options_;
  AdamOptions adam_;
  std::vector<TrainedQuantiles> critics_;
  QuantileNetwork<float> gradient_;
  std::vector<Runner> judging_;  // one a critic, for both ways back follow both ways forth
  Runner update_runner_;
  Runner target_runner_;
  Tiles<float> at_judged_;
  Tiles<float> at_learned_;
  Tiles<float> targets_;
  std::array<Buffer<float>, 2> risk_;  // of each critic, per lane
};

}  // namespace gust
