#pragma once

#include <string>

namespace gust {

/// A closed curve in a plane (a, b), run through once in a period of time (docs/plants.md 2.4).
///
///   circle    a = s cos wt           b = s sin wt
///   figure8   a = s sin wt           b = s sin wt cos wt
///   square    four sides of length s at constant speed: along +b, -a, -b, +a; starts at the origin
struct Trajectory {
  std::string shape = "circle";
  double scale = 1;   ///< s [m]
  double period = 1;  ///< [s]
};

/// Where a curve is, and how fast.
struct CurvePosition {
  double a, a_dot;  ///< [m], [m/s]
  double b, b_dot;
};

/// The position at a time [s] since the start.
CurvePosition curve_position(const Trajectory& trajectory, double time);

}  // namespace gust
