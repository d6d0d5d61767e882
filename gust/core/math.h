#pragma once

#include <cmath>
#include <limits>

#include "gust/core/pack.h"

namespace gust {

// Elementary functions whose bits are the same for scalars and packs, at every optimisation level and on every
// machine with fused multiply-add. They are inlined always: a call would cost a simulation step as much as their work.
// Polynomial coefficients of sine, cosine and logarithm are those of Sun's fdlibm (k_sin.c, k_cos.c, e_log.c); each
// function is within 2 units in the last place of the true value (math_test.cpp).

template <class T>
struct SinCos {
  T sin;
  T cos;
};

inline constexpr double kPi = 0x1.921fb54442d18p+1;

namespace detail {

template <class T>
struct Bits {
  using Int = PackMask;
};
template <>
struct Bits<double> {
  using Int = std::int64_t;
};

template <class T>
typename Bits<T>::Int as_int(T value) {
  typename Bits<T>::Int bits;
  __builtin_memcpy(&bits, &value, sizeof bits);
  return bits;
}
template <class T>
T as_float(typename Bits<T>::Int bits) {
  T value;
  __builtin_memcpy(&value, &bits, sizeof value);
  return value;
}

/// Sums that may wrap around, as they do where the result is thrown away.
inline std::int64_t wrapping_sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
inline PackMask wrapping_sum(PackMask a, PackMask b) { return a + b; }

/// Every constant as the type at hand.
template <class T>
T constant(double value) {
  return T{} + value;
}

/// Horner's rule, highest power first.
template <class T, class... Rest>
[[gnu::always_inline]] inline T horner(T x, double first, Rest... rest) {
  T sum = constant<T>(first);
  ((sum = fma(sum, x, constant<T>(rest))), ...);
  return sum;
}

inline constexpr double kRoundShift = 0x1.8p52;  // adding it leaves the nearest integer in the low bits

}  // namespace detail

/// Sine and cosine of x [rad]; accurate to 2 ulp for |x| < 1e5, usable to 1e9. NaN and infinity give NaN.
template <class T>
[[gnu::always_inline]] inline SinCos<T> sin_cos(T x) {
  using namespace detail;
  const T shifted = fma(x, constant<T>(0x1.45f306dc9c883p-1), constant<T>(kRoundShift));  // x * 2/pi
  const T quarter = shifted - kRoundShift;
  T r = fma(quarter, constant<T>(-0x1.921fb54442d18p+0), x);  // pi/2 in three parts
  r = fma(quarter, constant<T>(-0x1.1a62633145c07p-54), r);
  r = fma(quarter, constant<T>(0x1.f1976b7ed8fbcp-110), r);
  const T z = r * r;
  const T sin_tail = horner(z, 1.58969099521155010221e-10, -2.50507602534068634195e-08, 2.75573137070700676789e-06,
                            -1.98412698298579493134e-04, 8.33333333332248946124e-03, -1.66666666666666324348e-01);
  const T cos_tail = horner(z, -1.13596475577881948265e-11, 2.08757232129817482790e-09, -2.75573143513906633035e-07,
                            2.48015872894767294178e-05, -1.38888888888741095749e-03, 4.16666666666666019037e-02);
  const T sine = fma(r * z, sin_tail, r);
  const T half = z * 0.5;
  const T one_less = 1.0 - half;
  const T cosine = one_less + fma(z * z, cos_tail, (1.0 - one_less) - half);

  const auto quadrant = as_int(shifted);
  const auto swap = (quadrant & 1) != 0;
  const T sin_abs = select(swap, cosine, sine);
  const T cos_abs = select(swap, sine, cosine);
  const auto sin_sign = (quadrant & 2) << 62;
  const auto cos_sign = ((quadrant + 1) & 2) << 62;
  return {as_float<T>(as_int(sin_abs) ^ sin_sign), as_float<T>(as_int(cos_abs) ^ cos_sign)};
}

/// e to the x; 0 below -708, infinity above 709, NaN for NaN.
template <class T>
[[gnu::always_inline]] inline T exp(T x) {
  using namespace detail;
  const T shifted = fma(x, constant<T>(0x1.71547652b82fep+0), constant<T>(kRoundShift));  // x / ln 2
  const T power = shifted - kRoundShift;
  T r = fma(power, constant<T>(-0x1.62e42fefa39efp-1), x);  // ln 2 in two parts
  r = fma(power, constant<T>(-0x1.abc9e3b39803fp-56), r);
  const T tail = horner(r, 1.0 / 6227020800.0, 1.0 / 479001600.0, 1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0,
                        1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5);
  const T mantissa = 1.0 + fma(r * r, tail, r);
  const T scaled = as_float<T>(wrapping_sum(as_int(mantissa), as_int(shifted) << 52));
  const T finite = select(x < -708.0, T{}, scaled);
  return select(x > 709.0, constant<T>(std::numeric_limits<double>::infinity()), select(x == x, finite, x));
}

/// Natural logarithm of a positive normal number; what it gives for others is not defined.
template <class T>
[[gnu::always_inline]] inline T log(T x) {
  using namespace detail;
  const auto bits = as_int(x);
  const auto shift = bits - 0x3fe6a09e667f3bcd;  // sqrt(1/2): the mantissa then lies in [sqrt(1/2), sqrt(2))
  const auto exponent = shift >> 52;
  const T m = as_float<T>(bits - (exponent << 52));
  const T k = as_float<T>(exponent + as_int(constant<T>(kRoundShift))) - kRoundShift;
  const T f = m - 1.0;
  const T s = f / (2.0 + f);
  const T z = s * s;
  const T series = z * horner(z, 1.479819860511658591e-01, 1.531383769920937332e-01, 1.818357216161805012e-01,
                              2.222219843214978396e-01, 2.857142874366239149e-01, 3.999999999940941908e-01,
                              6.666666666666735130e-01);
  const T half_square = 0.5 * f * f;
  const T low = fma(s, half_square + series, k * 1.90821492927058770002e-10);
  return fma(k, constant<T>(6.93147180369123816490e-01), f - (half_square - low));
}

/// The angle in [-pi, pi), by whole turns.
template <class T>
[[gnu::always_inline]] inline T wrap_angle(T angle) {
  using namespace detail;
  const T turns = fma(angle, constant<T>(0x1.45f306dc9c883p-3), constant<T>(kRoundShift)) - kRoundShift;
  const T wrapped = fma(turns, constant<T>(-0x1.921fb54442d18p+2), angle);
  return select(wrapped >= 0x1.921fb54442d18p+1, wrapped - 0x1.921fb54442d18p+2, wrapped);
}

template <class T>
T absolute(T x) {
  return select(x < 0.0, -x, x);
}
inline double root(double x) { return __builtin_sqrt(x); }
inline Pack root(Pack x) { return __builtin_ia32_sqrtpd256(x); }
template <class T>
T clip(T x, T low, T high) {
  return select(x < low, low, select(x > high, high, x));
}

}  // namespace gust
