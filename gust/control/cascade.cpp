#include "gust/control/cascade.h"

#include "gust/control/tracking.h"
#include "gust/core/math.h"

namespace gust {
namespace {

class CascadePolicy final : public Policy {
 public:
  CascadePolicy(const Plant& plant, const Cascade& cascade)
      : cascade_(cascade),
        angle_(static_cast<Eigen::Index>(plant.spec().angle)),
        observations_(plant.spec().observations()),
        knots_(reference_knots(plant, cascade.inner)),
        scale_(plant.spec().action_scale),
        offset_(plant.spec().action_offset) {}

  std::size_t observations() const override { return observations_; }
  std::size_t actions() const override { return scale_.size(); }

  void act(Rows<const double> observation, std::span<const std::int64_t> step, Rows<double> action) override {
    for (std::size_t lane = 0; lane < action.lanes; ++lane) {
      const FeedbackKnot& knot = knots_[std::min(static_cast<std::size_t>(step[lane]), knots_.size() - 1)];
      Eigen::VectorXd error = knot.state;
      for (Eigen::Index j = 0; j < error.size(); ++j) error[j] -= observation.at(static_cast<std::size_t>(j), lane);
      double wanted = 0;
      for (Eigen::Index j = 0; j < error.size(); ++j) wanted += cascade_.outer[static_cast<std::size_t>(j)] * error[j];
      error[angle_] += clip(wanted, -cascade_.limit, cascade_.limit);
      const Eigen::VectorXd physical = cascade_.rest + cascade_.inner * error;
      for (std::size_t i = 0; i < scale_.size(); ++i)
        action.at(i, lane) = (physical[static_cast<Eigen::Index>(i)] - offset_[i]) / scale_[i];
    }
  }

 private:
  Cascade cascade_;
  Eigen::Index angle_;
  std::size_t observations_;
  std::vector<FeedbackKnot> knots_;
  std::vector<double> scale_, offset_;
};

}  // namespace

std::unique_ptr<Policy> cascade_policy(const Plant& plant, const Cascade& cascade) {
  return std::make_unique<CascadePolicy>(plant, cascade);
}

}  // namespace gust
