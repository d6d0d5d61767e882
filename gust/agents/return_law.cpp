#include "gust/agents/return_law.h"

#include <algorithm>
#include <cmath>

namespace gust {
namespace {

constexpr double kLeastVariance = 1e-8;  // of a target whose root is taken

double square(double x) { return x * x; }

double variance_loss(VarianceLoss loss, const ReturnLaw& law, double target) {
  switch (loss) {
    case VarianceLoss::kWasserstein:
      return square(law.deviation - std::sqrt(std::max(target, kLeastVariance)));
    case VarianceLoss::kUnbiased:
      return 0.5 * square(law.variance() - target);
    case VarianceLoss::kDivergence:
      break;
  }
  return law.variance() - target * log(law.variance());
}

/// Of that loss at the deviation.
double at_deviation(VarianceLoss loss, const ReturnLaw& law, double target) {
  switch (loss) {
    case VarianceLoss::kWasserstein:
      return 2.0 * (law.deviation - std::sqrt(std::max(target, kLeastVariance)));
    case VarianceLoss::kUnbiased:
      return 2.0 * law.deviation * (law.variance() - target);
    case VarianceLoss::kDivergence:
      break;
  }
  return 2.0 * (law.deviation - target / law.deviation);
}

}  // namespace

ReturnTarget return_target(const ReturnLossOptions& options, const ReturnSample& sample, double mean) {
  const double weight = options.discount * sample.follows;
  const double hard = sample.reward + weight * sample.next.mean;
  const double soft = hard - weight * sample.entropy_cost;
  const double x = options.entropy_in_variance ? soft : hard;
  // Factored: x^2 - mean^2 cancels catastrophically.
  const double spread = options.second_moment ? (x - mean) * (x + mean) : square(x - mean);
  return {soft, spread + options.discount * weight * sample.next.variance()};
}

double return_loss(const ReturnLossOptions& options, const ReturnLaw& law, const ReturnTarget& target) {
  return square(law.mean - target.mean) + variance_loss(options.loss, law, target.variance);
}

OutputSlope return_loss_slope(const ReturnLossOptions& options, const ReturnLaw& law, double x,
                              const ReturnTarget& target) {
  return {2.0 * (law.mean - target.mean), at_deviation(options.loss, law, target.variance) * sigmoid(x)};
}

}  // namespace gust
