#pragma once

#include "gust/nn/quantile_network.h"

namespace gust {

/// Quantiles of returns that a critic gave for some states and actions, and draws of the returns that it should have.
template <class T>
struct QuantileSamples {
  const Tiles<T>& quantiles;  ///< lanes x fractions
  const Fractions<T>& fractions;
  const Tiles<T>& targets;  ///< lanes x targets
};

/// The quantile Huber loss (Dabney et al. 2018; docs/algorithms.md 5.2), its mean over lanes, fractions i and targets
/// j, and its gradient at the quantiles:
///
///   rho(d_ij) = |tau_i - 1{d_ij < 0}| L(d_ij) / kappa         d_ij = y_j - Z_i
///   L(d) = d^2 / 2 for |d| <= kappa, else kappa (|d| - kappa / 2)
template <class T>
double quantile_loss(const QuantileSamples<T>& samples, double kappa, Tiles<T>& gradient) noexcept;

}  // namespace gust
