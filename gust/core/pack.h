#pragma once

#include <cstddef>
#include <cstdint>

namespace gust {

/// Four doubles side by side, one AVX register. Arithmetic is element by element and rounds as scalar code does.
using Pack = double __attribute__((vector_size(32)));
using PackMask = std::int64_t __attribute__((vector_size(32)));
inline constexpr std::size_t kPackLanes = 4;

inline Pack load(const double* from) {
  Pack value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}
inline void store(double* to, Pack value) { __builtin_memcpy(to, &value, sizeof value); }

inline double fma(double a, double b, double c) { return __builtin_fma(a, b, c); }
[[gnu::always_inline]] inline Pack fma(Pack a, Pack b, Pack c) {
  Pack result;
  for (std::size_t i = 0; i < kPackLanes; ++i) result[i] = __builtin_fma(a[i], b[i], c[i]);
  return result;
}

/// condition ? yes : no, for scalars and element by element for packs.
inline double select(bool condition, double yes, double no) { return condition ? yes : no; }
inline Pack select(PackMask condition, Pack yes, Pack no) { return condition ? yes : no; }

/// Whether the condition holds in any lane.
inline bool any(bool condition) { return condition; }
inline bool any(PackMask condition) { return __builtin_ia32_movmskpd256(reinterpret_cast<Pack>(condition)) != 0; }

}  // namespace gust
