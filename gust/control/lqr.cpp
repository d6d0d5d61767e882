#include "gust/control/lqr.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "gust/control/tracking.h"

namespace gust {
namespace {

class FeedbackPolicy final : public Policy {
 public:
  FeedbackPolicy(const PlantSpec& spec, std::vector<FeedbackKnot> knots)
      : knots_(std::move(knots)),
        observations_(spec.observations()),
        scale_(spec.action_scale),
        offset_(spec.action_offset) {}

  std::size_t observations() const override { return observations_; }
  std::size_t actions() const override { return scale_.size(); }

  void act(Rows<const double> observation, std::span<const std::int64_t> step, Rows<double> action) override {
    for (std::size_t lane = 0; lane < action.lanes; ++lane) {
      const FeedbackKnot& knot = knots_[std::min(static_cast<std::size_t>(step[lane]), knots_.size() - 1)];
      for (std::size_t i = 0; i < scale_.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        double physical = knot.action[row];
        for (Eigen::Index j = 0; j < knot.state.size(); ++j)
          physical -= knot.gain(row, j) * (observation.at(static_cast<std::size_t>(j), lane) - knot.state[j]);
        action.at(i, lane) = (physical - offset_[i]) / scale_[i];
      }
    }
  }

 private:
  std::vector<FeedbackKnot> knots_;
  std::size_t observations_;
  std::vector<double> scale_, offset_;
};

Eigen::MatrixXd diagonal(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())).asDiagonal();
}

Eigen::MatrixXd gain_of(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::MatrixXd& cost,
                        const LqrWeights& weights) {
  const Eigen::MatrixXd effort = diagonal(weights.r) + b.transpose() * cost * b;
  return effort.inverse() * b.transpose() * cost * a;
}

/// A moving reference has rates; at rest there are none.
void rest(const PlantSpec& spec, std::vector<double>& state) {
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (spec.state[i].name.ends_with("_dot")) state[i] = 0.0;
  }
}

/// Throws Error for a closed loop of which a part does not come to rest within about 1e9 steps, with the state that
/// this part moves most.
void check_settled(const Eigen::MatrixXd& loop, std::span<const Component> states) {
  constexpr double kNearestToOne = 1e-9;
  const std::string failed = "lqr: the Riccati equation has no stabilising solution";
  if (!loop.allFinite()) throw Error(cat(failed, "; weight the states that the action can reach"));
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(loop);
  Eigen::Index slowest = 0, state = 0;
  const double modulus = solver.eigenvalues().cwiseAbs().maxCoeff(&slowest);
  if (modulus < 1.0 - kNearestToOne) return;
  solver.eigenvectors().col(slowest).cwiseAbs().maxCoeff(&state);
  const auto index = static_cast<std::size_t>(state);
  const std::string name = index < states.size() ? states[index].name : cat("state ", index);
  throw Error(cat(failed, ": it does not bring ", name, " to rest (an eigenvalue of modulus ",
                  modulus < 1.0 ? cat("1 - ", fmt::format("{:.2g}", 1.0 - modulus)) : fmt::format("{:.6g}", modulus),
                  "); give ", name, " a weight, and weight the states that the action can reach"));
}

Eigen::MatrixXd solve(const Linearisation& model, const LqrWeights& weights, std::span<const Component> states) {
  constexpr int kMostDoublings = 60;
  const Eigen::Index n = model.a.rows();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd power = model.a;
  Eigen::MatrixXd control = model.b * diagonal(weights.r).inverse() * model.b.transpose();
  Eigen::MatrixXd cost = diagonal(weights.q);
  for (int i = 0; i < kMostDoublings; ++i) {
    const Eigen::MatrixXd inverse = (identity + control * cost).inverse();
    const Eigen::MatrixXd next_power = power * inverse * power;
    control += power * inverse * control * power.transpose();
    const Eigen::MatrixXd change = power.transpose() * cost * inverse * power;
    cost += change;
    power = next_power;
    if (!cost.allFinite()) break;
    if (change.norm() <= 1e-15 * cost.norm()) break;
  }
  const Eigen::MatrixXd solution = 0.5 * (cost + cost.transpose());
  check_settled(model.a - model.b * gain_of(model.a, model.b, solution, weights), states);
  return solution;
}

}  // namespace

Eigen::MatrixXd solve_riccati(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const LqrWeights& weights) {
  return solve({a, b}, weights, {});
}

Eigen::MatrixXd lqr_gain(const Plant& plant, const LqrWeights& weights) {
  const PlantSpec& spec = plant.spec();
  GUST_CHECK(weights.q.size() == spec.state.size() && weights.r.size() == spec.action.size());
  std::vector<double> goal(spec.state.size());
  plant.reference(0, goal);
  if (spec.references > 1) rest(spec, goal);
  const Linearisation model = plant.linearise(goal, spec.action_goal);
  return gain_of(model.a, model.b, solve(model, weights, spec.state), weights);
}

LqrWeights reward_weights(const PlantSpec& spec) {
  constexpr double kLeast = 0.1;         // a state that the reward ignores still has to settle
  constexpr double kLeastEffort = 0.01;  // of the policy's whole authority
  LqrWeights weights{spec.state_weights, {}};
  for (double& weight : weights.q) weight = std::max(weight, kLeast);
  for (std::size_t i = 0; i < spec.action.size(); ++i) {
    const double authority =
        spec.normalized_action ? spec.action_scale[i] : 0.5 * (spec.action_high[i] - spec.action_low[i]);
    weights.r.push_back(std::max(spec.action_weight, kLeastEffort / (authority * authority)));
  }
  return weights;
}

std::unique_ptr<Policy> feedback_policy(const Plant& plant, std::vector<FeedbackKnot> knots) {
  return std::make_unique<FeedbackPolicy>(plant.spec(), std::move(knots));
}

std::unique_ptr<Policy> feedback_policy(const Plant& plant, const Eigen::MatrixXd& gain) {
  return feedback_policy(plant, reference_knots(plant, gain));
}

std::unique_ptr<Policy> lqr_policy(const Plant& plant, const LqrWeights& weights) {
  const Eigen::MatrixXd gain = lqr_gain(plant, weights);
  if (plant.spec().references == 1) return feedback_policy(plant, gain);
  return feedback_policy(plant, tracking_knots(plant, weights, reference_knots(plant, gain)));
}

}  // namespace gust
