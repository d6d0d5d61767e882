#pragma once

#include "gust/core/math.h"

namespace gust {

/// What a critic of WCPG says of a return: N(mean, deviation^2) (docs/algorithms.md 4.1).
struct ReturnLaw {
  double mean = 0;
  double deviation = 0;

  double variance() const { return deviation * deviation; }
  /// The mean of the worst returns, c being the coefficient of their share (cvar.h).
  double cvar(double coefficient) const { return mean - coefficient * deviation; }
};

inline constexpr double kLeastDeviation = 1e-4;

/// ln(1 + e^x), without overflow.
inline double softplus(double x) { return (x > 0.0 ? x : 0.0) + log(1.0 + exp(x > 0.0 ? -x : x)); }
/// Its slope.
inline double sigmoid(double x) {
  const double small = exp(x > 0.0 ? -x : x);
  return (x > 0.0 ? 1.0 : small) / (1.0 + small);
}

/// The law that a critic's two outputs (Q, x) stand for: mean Q, deviation softplus(x) + 1e-4.
inline ReturnLaw return_law(double q, double x) { return {q, softplus(x) + kLeastDeviation}; }

/// The slope of some number at a critic's two outputs.
struct OutputSlope {
  double mean = 0;  ///< by Q
  double raw = 0;   ///< by x
};

/// Of the conditional value at risk.
inline OutputSlope cvar_slope(double coefficient, double x) { return {1.0, -coefficient * sigmoid(x)}; }

/// What a critic's variance V learns from, beside a target yV for it.
enum class VarianceLoss {
  kWasserstein,  ///< (s - sqrt(max(yV, 1e-8)))^2: published, biased by the root where targets are samples
  kUnbiased,     ///< (V - yV)^2 / 2: grows with the fourth power of returns
  kDivergence,   ///< V - yV ln V, the generalised Kullback-Leibler divergence: unbiased, in the unit of (Q - y)^2
};

/// How a critic's variance learns (docs/algorithms.md 4.3).
struct ReturnLossOptions {
  double discount = 0.99;
  bool second_moment = true;  ///< variance target from the second moment (published), else from the squared TD error
  VarianceLoss loss = VarianceLoss::kWasserstein;
  bool entropy_in_variance = true;  ///< whether the variance is that of the soft return
};

/// A transition as a critic sees it, with the law of what follows.
struct ReturnSample {
  double reward = 0;
  double follows = 1;       ///< m: 0 if the episode was terminated, else 1
  double entropy_cost = 0;  ///< T log pi(a'|s')
  ReturnLaw next;           ///< of the target critic with the smaller CVaR
};

/// What a critic of mean Q shall say. The variance target may be negative where the mean is not exact.
///
///   X = r + discount m (Q' - T log pi')                         the mean
///   (X - Q)(X + Q) + discount^2 m V'                            the variance, by the second moment
///   (X - Q)^2 + discount^2 m V'                                 the variance, by the squared TD error
struct ReturnTarget {
  double mean = 0;
  double variance = 0;
};
ReturnTarget return_target(const ReturnLossOptions& options, const ReturnSample& sample, double mean);

/// (Q - y)^2 and the loss of the variance; with the first of these, the squared 2-Wasserstein distance.
double return_loss(const ReturnLossOptions& options, const ReturnLaw& law, const ReturnTarget& target);

/// Of this loss at the outputs (law.mean, x).
OutputSlope return_loss_slope(const ReturnLossOptions& options, const ReturnLaw& law, double x,
                              const ReturnTarget& target);

}  // namespace gust
