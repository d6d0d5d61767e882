#include "gust/control/tracking.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "gust/core/math.h"

namespace gust {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd vector_of(std::span<const double> values) {
  return Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// What the state after step k is judged by.
VectorXd target_after(const Plant& plant, std::size_t k) {
  const PlantSpec& spec = plant.spec();
  const std::size_t sample = k + 1 - std::min(spec.reference_lag, k + 1);
  std::vector<double> state(spec.state.size());
  plant.reference(std::min(sample, spec.references - 1), state);
  return vector_of(state);
}

/// A problem and its cost.
struct Tracking {
  const Plant& plant;
  VectorXd q, r, rest;
  std::vector<VectorXd> target;  // per step

  Tracking(const Plant& of, const LqrWeights& weights)
      : plant(of), q(vector_of(weights.q)), r(vector_of(weights.r)), rest(vector_of(of.spec().action_goal)) {
    for (std::int64_t k = 0; k < of.spec().steps; ++k) target.push_back(target_after(of, static_cast<std::size_t>(k)));
  }
  double cost(std::size_t k, const VectorXd& action, const VectorXd& next) const {
    const VectorXd error = next - target[k];
    const VectorXd effort = action - rest;
    return error.dot(q.cwiseProduct(error)) + effort.dot(r.cwiseProduct(effort));
  }
};

/// What happens under feedback, from the nominal start.
struct Motions {
  std::vector<VectorXd> state;  // before each step, and after the last
  std::vector<VectorXd> action;
  double cost = 0;
};

Motions run(const Tracking& problem, const std::vector<FeedbackKnot>& knots) {
  const PlantSpec& spec = problem.plant.spec();
  const std::size_t states = spec.state.size();
  Matrix<double> state(states + spec.hidden, 1), parameters(spec.parameters.size(), 1), action(spec.action.size(), 1),
      force(spec.force.size(), 1);
  for (std::size_t i = 0; i < states; ++i) state.at(i, 0) = spec.start[i];
  for (std::size_t i = 0; i < parameters.rows(); ++i) std::ranges::fill(parameters.row(i), spec.parameters[i].nominal);
  problem.plant.begin(state.view(), 0, false);

  Motions motions;
  const auto now = [&] {
    VectorXd x(static_cast<Eigen::Index>(states));
    for (std::size_t i = 0; i < states; ++i) x[static_cast<Eigen::Index>(i)] = state.at(i, 0);
    return x;
  };
  motions.state.push_back(now());
  for (std::size_t k = 0; k < problem.target.size(); ++k) {
    const FeedbackKnot& knot = knots[std::min(k, knots.size() - 1)];
    VectorXd u = knot.action - knot.gain * (motions.state.back() - knot.state);
    for (std::size_t i = 0; i < action.rows(); ++i) {
      double& component = u[static_cast<Eigen::Index>(i)];
      component = clip(component, spec.action_low[i], spec.action_high[i]);
      action.at(i, 0) = component;
    }
    problem.plant.advance({state.view(), parameters.view(), action.view(), force.view()});
    motions.action.push_back(u);
    motions.state.push_back(now());
    motions.cost += problem.cost(k, u, motions.state.back());
  }
  return motions;
}

struct Improvement {
  std::vector<VectorXd> change;  // of each action
  std::vector<MatrixXd> gain;
};

/// Backwards through time: the best feedback about a motion, the plant taken as linear near it.
Improvement improve(const Tracking& problem, const Motions& motions) {
  const std::size_t steps = motions.action.size();
  Improvement result{std::vector<VectorXd>(steps), std::vector<MatrixXd>(steps)};
  VectorXd slope = VectorXd::Zero(problem.q.size());
  MatrixXd curvature = MatrixXd::Zero(problem.q.size(), problem.q.size());
  for (std::size_t k = steps; k-- > 0;) {
    const auto span = [](const VectorXd& v) { return std::span(v.data(), static_cast<std::size_t>(v.size())); };
    const Linearisation model = problem.plant.linearise(span(motions.state[k]), span(motions.action[k]));
    const VectorXd p = slope + problem.q.cwiseProduct(motions.state[k + 1] - problem.target[k]);
    const MatrixXd c = curvature + MatrixXd(problem.q.asDiagonal());
    const MatrixXd effort = model.b.transpose() * c * model.b + MatrixXd(problem.r.asDiagonal());
    const MatrixXd mixed = model.b.transpose() * c * model.a;
    const VectorXd pull = problem.r.cwiseProduct(motions.action[k] - problem.rest) + model.b.transpose() * p;
    const Eigen::LDLT<MatrixXd> factor(effort);
    result.gain[k] = factor.solve(mixed);
    result.change[k] = -factor.solve(pull);
    slope = model.a.transpose() * p + mixed.transpose() * result.change[k];
    curvature = model.a.transpose() * c * model.a - mixed.transpose() * result.gain[k];
    curvature = (0.5 * (curvature + curvature.transpose())).eval();
  }
  return result;
}

std::vector<FeedbackKnot> knots_about(const Motions& motions, const Improvement& improvement, double share) {
  std::vector<FeedbackKnot> knots;
  for (std::size_t k = 0; k < motions.action.size(); ++k)
    knots.push_back({motions.state[k], motions.action[k] + share * improvement.change[k], improvement.gain[k]});
  return knots;
}

}  // namespace

std::vector<FeedbackKnot> reference_knots(const Plant& plant, const Eigen::MatrixXd& gain) {
  const PlantSpec& spec = plant.spec();
  const std::size_t count = spec.references == 1 ? 1 : static_cast<std::size_t>(spec.steps);
  std::vector<FeedbackKnot> knots;
  for (std::size_t k = 0; k < count; ++k) knots.push_back({target_after(plant, k), vector_of(spec.action_goal), gain});
  return knots;
}

std::vector<FeedbackKnot> tracking_knots(const Plant& plant, const LqrWeights& weights,
                                         std::vector<FeedbackKnot> start) {
  constexpr int kMostRounds = 50;
  constexpr double kLeastShare = 1e-3;  // of a step that is tried
  constexpr double kLeastGain = 1e-9;   // relative, in cost
  const Tracking problem(plant, weights);
  Motions motions = run(problem, start);
  Improvement improvement = improve(problem, motions);
  for (int round = 0; round < kMostRounds; ++round) {
    double share = 1.0;
    Motions next = run(problem, knots_about(motions, improvement, share));
    while (!(next.cost < motions.cost) && share > kLeastShare) {
      share *= 0.5;
      next = run(problem, knots_about(motions, improvement, share));
    }
    if (!(next.cost < motions.cost)) break;
    const bool settled = motions.cost - next.cost < kLeastGain * motions.cost;
    motions = std::move(next);
    improvement = improve(problem, motions);
    if (settled) break;
  }
  return knots_about(motions, improvement, 0.0);
}

}  // namespace gust
