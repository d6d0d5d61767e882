#pragma once

#include <array>

#include "gust/core/math.h"

namespace gust {

/// A number that carries its exact derivatives with respect to N inputs. Plain values, no expression templates, so
/// that a law written with `auto` means the same for duals as for doubles.
template <int N>
struct Dual {
  double value = 0;
  std::array<double, N> slope{};

  Dual() = default;
  Dual(double constant) : value(constant) {}  // NOLINT: a constant is a dual number without slope

  /// Input number `index`, with derivative one by itself.
  static Dual input(double value, int index) {
    Dual result(value);
    result.slope[index] = 1.0;
    return result;
  }

  friend Dual operator+(const Dual& a, const Dual& b) { return combine(a.value + b.value, a, 1.0, b, 1.0); }
  friend Dual operator-(const Dual& a, const Dual& b) { return combine(a.value - b.value, a, 1.0, b, -1.0); }
  friend Dual operator*(const Dual& a, const Dual& b) { return combine(a.value * b.value, a, b.value, b, a.value); }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double ratio = a.value / b.value;
    return combine(ratio, a, 1.0 / b.value, b, -ratio / b.value);
  }
  friend Dual operator-(const Dual& a) { return Dual(0.0) - a; }
  friend bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend bool operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend bool operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }

  friend Dual select(bool condition, const Dual& yes, const Dual& no) { return condition ? yes : no; }
  friend Dual root(const Dual& x) {
    const double value = gust::root(x.value);
    return combine(value, x, value > 0.0 ? 0.5 / value : 0.0, x, 0.0);
  }
  friend SinCos<Dual> sin_cos(const Dual& x) {
    const SinCos<double> at = gust::sin_cos(x.value);
    return {combine(at.sin, x, at.cos, x, 0.0), combine(at.cos, x, -at.sin, x, 0.0)};
  }

 private:
  static Dual combine(double value, const Dual& a, double da, const Dual& b, double db) {
    Dual result(value);
    for (int i = 0; i < N; ++i) result.slope[i] = da * a.slope[i] + db * b.slope[i];
    return result;
  }
};

}  // namespace gust
