#pragma once

#include <immintrin.h>

#include <cstddef>
#include <utility>

namespace gust {

/// One AVX register of T, for the few loops that a compiler does not vectorise by itself. Arithmetic is element by
/// element and rounds as scalar code does.
template <class T>
struct VecOf {
  typedef T type __attribute__((vector_size(32)));  // NOLINT: GCC takes the attribute of a dependent type only here
};
template <class T>
using Vec = typename VecOf<T>::type;

template <class T>
inline constexpr std::size_t kVecWidth = 32 / sizeof(T);

/// Unaligned access, for vectors and for scalars.
template <class V, class T>
V load_as(const T* from) {
  V value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}
template <class V, class T>
void store_as(T* to, V value) {
  __builtin_memcpy(to, &value, sizeof value);
}

/// a b + c, rounded once.
inline float fused(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
inline double fused(double a, double b, double c) { return __builtin_fma(a, b, c); }
template <class V>
V fused(V a, V b, V c) {
  V result;
  for (std::size_t i = 0; i < sizeof(V) / sizeof(a[0]); ++i) result[i] = fused(a[i], b[i], c[i]);
  return result;
}

/// The lesser of a and b, b where they cannot be compared: one instruction, which compilers do not find by themselves.
inline float lesser(float a, float b) { return a < b ? a : b; }
inline double lesser(double a, double b) { return a < b ? a : b; }
inline Vec<float> lesser(Vec<float> a, Vec<float> b) { return _mm256_min_ps(a, b); }
inline Vec<double> lesser(Vec<double> a, Vec<double> b) { return _mm256_min_pd(a, b); }

/// The greater of a and b, b where they cannot be compared.
inline float greater(float a, float b) { return a > b ? a : b; }
inline double greater(double a, double b) { return a > b ? a : b; }
inline Vec<float> greater(Vec<float> a, Vec<float> b) { return _mm256_max_ps(a, b); }
inline Vec<double> greater(Vec<double> a, Vec<double> b) { return _mm256_max_pd(a, b); }

/// f(0) … f(kCount - 1), written out one after the other so that small arrays stay in registers.
template <std::size_t kCount, class F>
[[gnu::always_inline]] inline void unrolled(F&& f) {
  [&]<std::size_t... i>(std::index_sequence<i...>) __attribute__((always_inline)) { (f(i), ...); }
  (std::make_index_sequence<kCount>{});
}

}  // namespace gust
