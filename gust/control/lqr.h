#pragma once

#include "gust/control/policy.h"
#include "gust/sim/plant.h"

namespace gust {

/// Weights of the cost sum x'Qx + u'Ru that the regulator minimises; the diagonal of each.
struct LqrWeights {
  std::vector<double> q;  ///< per state component
  std::vector<double> r;  ///< per physical action, > 0
};

/// The infinite-horizon discrete gain K of u = u* - K (x - x*), actions x states, from the plant's exact
/// linearisation at rest where its reference begins. Throws Error if no stabilising solution is found, with the state
/// that stays unstabilised: one whose part of the closed loop has an eigenvalue within 1e-9 of modulus 1, or above.
Eigen::MatrixXd lqr_gain(const Plant& plant, const LqrWeights& weights);

/// Solves the discrete algebraic Riccati equation by the structure-preserving doubling algorithm (Chu, Fan, Lin 2005).
/// Throws Error if it does not converge.
Eigen::MatrixXd solve_riccati(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const LqrWeights& weights);

/// Weights that make the regulator's cost the reward's: those of the plant, with what it leaves free made small.
LqrWeights reward_weights(const PlantSpec& spec);

/// What feedback aims at in one control step: u = action - gain (x - state), physical.
struct FeedbackKnot {
  Eigen::VectorXd state;
  Eigen::VectorXd action;
  Eigen::MatrixXd gain;
};

/// State feedback with one knot a control step, the last one holding on, in the policy's action unit.
std::unique_ptr<Policy> feedback_policy(const Plant& plant, std::vector<FeedbackKnot> knots);

/// The same with one gain about the plant's reference, step by step.
std::unique_ptr<Policy> feedback_policy(const Plant& plant, const Eigen::MatrixXd& gain);

/// The linear-quadratic regulator: about a goal the gain of lqr_gain; along a moving reference the time-varying one of
/// tracking_knots.
std::unique_ptr<Policy> lqr_policy(const Plant& plant, const LqrWeights& weights);

}  // namespace gust
