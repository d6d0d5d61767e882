#include "gust/sim/trajectory.h"

#include <cmath>

#include "gust/core/math.h"

namespace gust {
namespace {

CurvePosition on_square(double scale, double period, double time) {
  const double sides = 4.0 * time / period;
  const double whole = std::floor(sides);
  const double along = scale * (sides - whole);
  const double speed = 4.0 * scale / period;
  const double side = std::fmod(whole, 4.0);  // no integer need hold the number of rounds
  if (side == 0.0) return {0, 0, along, speed};
  if (side == 1.0) return {-along, -speed, scale, 0};
  if (side == 2.0) return {-scale, 0, scale - along, -speed};
  return {along - scale, speed, 0, 0};
}

}  // namespace

CurvePosition curve_position(const Trajectory& trajectory, double time) {
  const double scale = trajectory.scale;
  if (trajectory.shape == "square") return on_square(scale, trajectory.period, time);
  const double rate = 2.0 * kPi / trajectory.period;
  const auto [sine, cosine] = sin_cos(rate * time);
  if (trajectory.shape == "circle") {
    return {scale * cosine, -scale * rate * sine, scale * sine, scale * rate * cosine};
  }
  return {scale * sine, scale * rate * cosine, scale * sine * cosine, scale * rate * (cosine * cosine - sine * sine)};
}

}  // namespace gust
