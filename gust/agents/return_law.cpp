#include "gust/agents/return_law.h"

#include <algorithm>
#include <cmath>

namespace gust {
namespace {

constexpr double kLeastVariance = 1e-8;  // of a target whose root is taken

double square(double x) { return x * x; }

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
  const double mean_part = square(law.mean - target.mean);
  if (!options.wasserstein) return mean_part + 0.5 * square(law.variance() - target.variance);
  return mean_part + square(law.deviation - std::sqrt(std::max(target.variance, kLeastVariance)));
}

template <class T>
double return_loss(const ReturnLossOptions& options, std::span<const T> outputs, std::span<const ReturnSample> samples,
                   std::span<T> gradient) {
  double sum = 0.0;
  const double share = 1.0 / static_cast<double>(samples.size());
  for (std::size_t lane = 0; lane < samples.size(); ++lane) {
    const ReturnLaw law = return_law(&outputs[2 * lane]);
    const ReturnTarget target = return_target(options, samples[lane], law.mean);
    sum += return_loss(options, law, target);
    const double at_deviation = options.wasserstein
                                    ? 2.0 * (law.deviation - std::sqrt(std::max(target.variance, kLeastVariance)))
                                    : 2.0 * law.deviation * (law.variance() - target.variance);
    gradient[2 * lane] = static_cast<T>(2.0 * share * (law.mean - target.mean));
    gradient[2 * lane + 1] = static_cast<T>(share * at_deviation * sigmoid(static_cast<double>(outputs[2 * lane + 1])));
  }
  return sum * share;
}

template double return_loss(const ReturnLossOptions&, std::span<const float>, std::span<const ReturnSample>,
                            std::span<float>);
template double return_loss(const ReturnLossOptions&, std::span<const double>, std::span<const ReturnSample>,
                            std::span<double>);

}  // namespace gust
