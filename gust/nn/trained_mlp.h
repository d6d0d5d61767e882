#pragma once

#include <optional>

#include "gust/nn/adam.h"
#include "gust/nn/tiled_mlp.h"

namespace gust {

/// A network that learns from batches in tiles, with its optimiser and, where it has one, a target network that follows
/// it. A layer's gradient is consumed as soon as it is known: one pass moves its parameters, their moments and the
/// copy.
template <class T>
class TrainedMlp {
 public:
  enum class Target { kNo, kYes };

  TrainedMlp(const MlpShape& shape, std::size_t lanes, typename TiledMlp<T>::InputRange wanted, Target target);

  Mlp<T>& mlp() { return mlp_; }
  const Mlp<T>& mlp() const { return mlp_; }
  /// What follows the network; it starts equal to it when start() is called.
  const Mlp<T>& target() const { return *target_; }
  /// To be called when the network has its first parameters.
  void start() {
    if (target_) target_ = mlp_;
  }
  bool finite() const;

  const Tiles<T>& forward(const Tiles<T>& input) noexcept { return tiled_.forward(mlp_, input); }
  /// Of the copy; forgets the last forward.
  const Tiles<T>& forward_target(const Tiles<T>& input) noexcept { return tiled_.forward(*target_, input); }
  const Tiles<T>& backward_to_input(const Tiles<T>& at_output) noexcept {
    return tiled_.backward_to_input(mlp_, at_output);
  }

  /// One step of Adam from the gradient at the outputs of the last forward; the copy moves by `share` towards it.
  void step(const AdamOptions& options, const Tiles<T>& at_output, T share = T(0)) noexcept;

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    archive.block(self.mlp_.parameters());
    if (self.target_) archive.block(self.target_->parameters());
    archive.block(std::span(self.adam_.first));
    archive.block(std::span(self.adam_.second));
    archive.number(self.adam_.beta1_power);
    archive.number(self.adam_.beta2_power);
  }

 private:
  Mlp<T> mlp_;
  std::optional<Mlp<T>> target_;
  AdamState<T> adam_;
  TiledMlp<T> tiled_;
  Buffer<T> gradient_;  // of one layer
};

}  // namespace gust
