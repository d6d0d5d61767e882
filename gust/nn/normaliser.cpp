#include "gust/nn/normaliser.h"

#include <cmath>

#include "gust/core/math.h"

namespace gust {
namespace {

constexpr double kFloor = 1e-8;
constexpr double kLimit = 10.0;

}  // namespace

void update_moments(RunningMoments& moments, Rows<const double> batch) noexcept {
  const auto added = static_cast<double>(batch.lanes);
  const double count = moments.count + added;
  for (std::size_t i = 0; i < batch.rows; ++i) {
    double sum = 0.0;
    for (const double x : batch.row(i)) sum += x;
    const double mean = sum / added;
    double squares = 0.0;
    for (const double x : batch.row(i)) squares += (x - mean) * (x - mean);
    const double delta = mean - moments.mean[i];
    moments.mean[i] += delta * added / count;
    moments.variance[i] =
        (moments.variance[i] * moments.count + squares + delta * delta * moments.count * added / count) / count;
  }
  moments.count = count;
}

void normalise(const RunningMoments& moments, Rows<const double> x, Rows<double> to) noexcept {
  for (std::size_t i = 0; i < x.rows; ++i) {
    const double scale = 1.0 / std::sqrt(moments.variance[i] + kFloor);
    for (std::size_t lane = 0; lane < x.lanes; ++lane)
      to.at(i, lane) = clip((x.at(i, lane) - moments.mean[i]) * scale, -kLimit, kLimit);
  }
}

void scale_rewards(RewardScale& scale, double discount, std::span<const std::uint8_t> done,
                   std::span<double> reward) noexcept {
  for (std::size_t i = 0; i < reward.size(); ++i) scale.discounted[i] = discount * scale.discounted[i] + reward[i];
  update_moments(scale.moments, {scale.discounted.data(), 1, reward.size(), reward.size()});
  const double factor = 1.0 / std::sqrt(scale.moments.variance[0] + kFloor);
  for (std::size_t i = 0; i < reward.size(); ++i) {
    reward[i] = clip(reward[i] * factor, -kLimit, kLimit);
    if (done[i]) scale.discounted[i] = 0.0;
  }
}

}  // namespace gust
