#pragma once

#include <immintrin.h>

#include <ctime>

// The most that one core can do: fused multiply-adds in float, 2 FLOP each, with the widest registers that it has.
// Twelve independent chains hide the latency of every core that we know (two units, four to five cycles).

namespace gust::bench {

inline constexpr int kChains = 12;

__attribute__((target("avx512f"))) inline float multiply_add_512(long rounds) {
  __m512 sum[kChains];
  for (int i = 0; i < kChains; ++i) sum[i] = _mm512_set1_ps(static_cast<float>(i));
  const __m512 factor = _mm512_set1_ps(0.999f);
  const __m512 term = _mm512_set1_ps(0.001f);
  for (long round = 0; round < rounds; ++round) {
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) sum[i] = _mm512_fmadd_ps(sum[i], factor, term);
  }
  float total = 0.0f;
  for (int i = 0; i < kChains; ++i) total += _mm512_cvtss_f32(sum[i]);
  return total;
}

inline float multiply_add_256(long rounds) {
  __m256 sum[kChains];
  for (int i = 0; i < kChains; ++i) sum[i] = _mm256_set1_ps(static_cast<float>(i));
  const __m256 factor = _mm256_set1_ps(0.999f);
  const __m256 term = _mm256_set1_ps(0.001f);
  for (long round = 0; round < rounds; ++round) {
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) sum[i] = _mm256_fmadd_ps(sum[i], factor, term);
  }
  float total = 0.0f;
  for (int i = 0; i < kChains; ++i) total += _mm256_cvtss_f32(sum[i]);
  return total;
}

/// Seconds that this thread has computed: what others do on a shared machine does not count.
inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The shortest time of some runs of f [s]: what the core does when nothing else disturbs it.
template <class F>
double shortest(int runs, F&& f) {
  double best = 1e300;
  for (int run = 0; run < runs; ++run) {
    const double start = thread_seconds();
    f();
    const double taken = thread_seconds() - start;
    if (taken < best) best = taken;
  }
  return best;
}

/// FLOP/s of the core, measured now; about a tenth of a second.
inline double measure_peak() {
  const bool wide = __builtin_cpu_supports("avx512f");
  const long rounds = 20'000;
  volatile float keep = 0.0f;
  const double time = shortest(300, [&] { keep = wide ? multiply_add_512(rounds) : multiply_add_256(rounds); });
  return 2.0 * (wide ? 16 : 8) * kChains * static_cast<double>(rounds) / time;
}

/// The same, measured once per program.
inline double peak() {
  static const double value = measure_peak();
  return value;
}

}  // namespace gust::bench
