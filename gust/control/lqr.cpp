#include "gust/control/lqr.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

namespace gust {
namespace {

class FeedbackPolicy final : public Policy {
 public:
  FeedbackPolicy(const Plant& plant, Eigen::MatrixXd gain)
      : gain_(std::move(gain)),
        goal_(plant.spec().state.size()),
        action_goal_(plant.spec().action_goal),
        scale_(plant.spec().action_scale),
        offset_(plant.spec().action_offset) {
    plant.goal(goal_);
  }

  std::size_t observations() const override { return goal_.size(); }
  std::size_t actions() const override { return scale_.size(); }

  void act(Rows<const double> observation, Rows<double> action) override {
    for (std::size_t i = 0; i < scale_.size(); ++i) {
      for (std::size_t lane = 0; lane < action.lanes; ++lane) {
        double physical = action_goal_[i];
        for (std::size_t j = 0; j < goal_.size(); ++j) {
          physical -=
              gain_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * (observation.at(j, lane) - goal_[j]);
        }
        action.at(i, lane) = (physical - offset_[i]) / scale_[i];
      }
    }
  }

 private:
  Eigen::MatrixXd gain_;
  std::vector<double> goal_, action_goal_, scale_, offset_;
};

Eigen::MatrixXd diagonal(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())).asDiagonal();
}

Eigen::MatrixXd gain_of(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::MatrixXd& cost,
                        const LqrWeights& weights) {
  const Eigen::MatrixXd effort = diagonal(weights.r) + b.transpose() * cost * b;
  return effort.inverse() * b.transpose() * cost * a;
}

bool settles(const Eigen::MatrixXd& loop) { return loop.allFinite() && loop.eigenvalues().cwiseAbs().maxCoeff() < 1.0; }

}  // namespace

Eigen::MatrixXd solve_riccati(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const LqrWeights& weights) {
  constexpr int kMostDoublings = 60;
  const Eigen::Index n = a.rows();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd power = a;
  Eigen::MatrixXd control = b * diagonal(weights.r).inverse() * b.transpose();
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
  if (!solution.allFinite() || !settles(a - b * gain_of(a, b, solution, weights))) {
    throw Error("lqr: the Riccati equation has no stabilising solution; weight the states that the action can reach");
  }
  return solution;
}

Eigen::MatrixXd lqr_gain(const Plant& plant, const LqrWeights& weights) {
  const PlantSpec& spec = plant.spec();
  GUST_CHECK(weights.q.size() == spec.state.size() && weights.r.size() == spec.action.size());
  std::vector<double> goal(spec.state.size());
  plant.goal(goal);
  const Linearisation model = plant.linearise(goal, spec.action_goal);
  return gain_of(model.a, model.b, solve_riccati(model.a, model.b, weights), weights);
}

LqrWeights reward_weights(const PlantSpec& spec) {
  constexpr double kLeast = 0.1;  // a state that the reward ignores still has to settle
  constexpr double kLeastEffort = 1e-4;
  LqrWeights weights{spec.state_weights, {}};
  for (double& weight : weights.q) weight = std::max(weight, kLeast);
  weights.r.assign(spec.action.size(), std::max(spec.action_weight, kLeastEffort));
  return weights;
}

std::unique_ptr<Policy> feedback_policy(const Plant& plant, const Eigen::MatrixXd& gain) {
  return std::make_unique<FeedbackPolicy>(plant, gain);
}

}  // namespace gust
