#pragma once

#include <immintrin.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

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

/// Whether the programs are only to show that they run: with loads so small that their figures mean nothing.
inline bool once() { return std::getenv("GUST_BENCH_ONCE") != nullptr; }

/// The shortest time of some runs of f [s]: what the core does when nothing else disturbs it.
template <class F>
double shortest(int runs, F&& f) {
  double best = 1e300;
  for (int run = 0; run < runs; ++run) {
    const auto start = std::chrono::steady_clock::now();
    f();
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    best = std::min(best, taken.count());
  }
  return best;
}

/// FLOP/s of the core with the widest registers that it has, measured now; about a fifth of a second.
inline double measure_peak() {
  const bool wide = __builtin_cpu_supports("avx512f");
  const long rounds = 20'000;
  const int runs = once() ? 1 : 600;
  volatile float keep = 0.0f;
  const double time = shortest(runs, [&] { keep = wide ? multiply_add_512(rounds) : multiply_add_256(rounds); });
  const double time_256 =
      shortest(runs, [&] { keep = multiply_add_256(rounds); });  // some clock higher without AVX-512
  const double per_lane = 2.0 * kChains * static_cast<double>(rounds);
  const double narrow = 8 * per_lane / time_256;
  return wide ? std::max(16 * per_lane / time, narrow) : narrow;
}

/// The highest that was measured so far: the clock moves while a program runs, and no kernel may exceed its peak, so
/// every figure asks anew.
inline double peak() {
  static double highest = 0.0;
  highest = std::max(highest, measure_peak());
  return highest;
}

}  // namespace gust::bench
