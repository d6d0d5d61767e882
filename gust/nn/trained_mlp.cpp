#include "gust/nn/trained_mlp.h"

#include <algorithm>
#include <cmath>

namespace gust {
template <class T>
TrainedMlp<T>::TrainedMlp(const MlpShape& shape, std::size_t lanes, typename TiledMlp<T>::InputRange wanted,
                          Target target)
    : mlp_(shape), adam_(mlp_.parameters().size()), tiled_(shape, lanes, wanted) {
  if (target == Target::kYes) target_ = mlp_;
  std::size_t largest = 0;
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) largest = std::max(largest, mlp_.parameters_of(layer));
  gradient_.resize(largest);
}

template <class T>
bool TrainedMlp<T>::finite() const {
  return std::ranges::all_of(mlp_.parameters(), [](T value) { return std::isfinite(value); });
}

template <class T>
void TrainedMlp<T>::step(const AdamOptions& options, const Tiles<T>& at_output, T share) noexcept {
  const AdamStep<T> step(options, adam_);
  tiled_.begin_backward(at_output);
  for (std::size_t layer = mlp_.shape().layers(); layer-- > 0;) {
    const std::size_t first = mlp_.weights_at(layer);
    const std::size_t count = mlp_.parameters_of(layer);
    const std::span gradient(gradient_.data(), count);
    tiled_.backward_layer(mlp_, layer, gradient);
    const auto part = [&](auto&& all) { return std::span(all).subspan(first, count); };
    const AdamPart<T> moved = {part(mlp_.parameters()), gradient, part(adam_.first), part(adam_.second)};
    target_ ? adam_move<T>(step, moved, {part(target_->parameters()), share}) : adam_move<T>(step, moved);
  }
}

template class TrainedMlp<float>;
template class TrainedMlp<double>;

}  // namespace gust
