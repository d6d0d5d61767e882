#pragma once

#include "gust/core/rng.h"
#include "gust/nn/mlp.h"

namespace gust {

/// Draws weights and biases of every layer from U(-b, b) with b = 1 / sqrt(inputs of the layer): what PyTorch's linear
/// layers start with.
template <class T>
void initialise_uniform(Mlp<T>& mlp, Rng rng);

struct OrthogonalGains {
  double hidden = 1.4142135623730951;
  double output = 1.0;
};

/// Weights with orthogonal rows (or columns, where there are more outputs than inputs) of length gain, biases zero
/// (Saxe et al. 2013). The direction is uniform: Gram and Schmidt on normal draws, in double.
template <class T>
void initialise_orthogonal(Mlp<T>& mlp, OrthogonalGains gains, Rng rng);

}  // namespace gust
