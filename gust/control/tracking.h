#pragma once

#include "gust/control/lqr.h"

namespace gust {

/// Knots that aim, with one gain, at the reference that the next step is judged by.
std::vector<FeedbackKnot> reference_knots(const Plant& plant, const Eigen::MatrixXd& gain);

/// The regulator along a moving reference, which need not be a motion that the plant can make: minimises
/// sum (x - r)'Q(x - r) + (u - u*)'R(u - u*) over the episode from the nominal start by iterated linear-quadratic steps
/// (Li, Todorov 2004) with exact linearisations, starting from a motion under `start`; the knots are the motion found
/// and the gains about it.
std::vector<FeedbackKnot> tracking_knots(const Plant& plant, const LqrWeights& weights,
                                         std::vector<FeedbackKnot> start);

}  // namespace gust
