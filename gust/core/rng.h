#pragma once

#include <Random123/philox.h>

#include <cstdint>
#include <string_view>

#include "gust/core/math.h"

namespace gust {

/// A named stream of random numbers with random access: counter-based Philox4x32-10, no mutable state.
///
/// A stream is identified by the seed and the path of splits that led to it; number i of a stream never depends on
/// which others were drawn. Copy it freely; equal paths give equal bits on every machine.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : key_(mix(seed, 0x67757374'00000000u)) {}

  /// The stream of a numbered child (an episode, a lane, a channel).
  Rng split(std::uint64_t index) const { return Rng(mix(key_, index), Raw{}); }

  /// The stream of a named purpose.
  Rng split(std::string_view purpose) const {
    std::uint64_t tag = 0xcbf29ce484222325u;  // FNV-1a
    for (const char letter : purpose) tag = (tag ^ static_cast<unsigned char>(letter)) * 0x100000001b3u;
    return Rng(mix(~key_, tag), Raw{});
  }

  /// 64 uniform bits.
  std::uint64_t bits(std::uint64_t i) const { return block(i).low; }

  /// Uniform in [0, 1), 53 bits.
  double uniform(std::uint64_t i) const { return unit(block(i).low); }

  /// Standard normal, by Box and Muller.
  double normal(std::uint64_t i) const {
    const Block random = block(i);
    const double radius = __builtin_sqrt(-2.0 * log(1.0 - unit(random.low)));
    return radius * sin_cos(6.283185307179586476925 * unit(random.high)).cos;
  }

  /// Uniform in 0 … n-1 for n > 0; the bias is below n / 2^64.
  std::uint64_t below(std::uint64_t n, std::uint64_t i) const {
    return static_cast<std::uint64_t>((static_cast<unsigned __int128>(bits(i)) * n) >> 64);
  }

  friend bool operator==(const Rng&, const Rng&) = default;

 private:
  struct Raw {};
  struct Block {
    std::uint64_t low;
    std::uint64_t high;
  };

  Rng(std::uint64_t key, Raw) : key_(key) {}

  static double unit(std::uint64_t random) { return static_cast<double>(random >> 11) * 0x1p-53; }

  static Block philox(std::uint64_t key, std::uint64_t counter, std::uint64_t kind) {
    const auto word = [](std::uint64_t value, int index) { return static_cast<std::uint32_t>(value >> (32 * index)); };
    const r123::Philox4x32::ctr_type in = {{word(counter, 0), word(counter, 1), word(kind, 0), word(kind, 1)}};
    const r123::Philox4x32::key_type k = {{word(key, 0), word(key, 1)}};
    const auto out = r123::Philox4x32{}(in, k);
    return {out[0] | std::uint64_t{out[1]} << 32, out[2] | std::uint64_t{out[3]} << 32};
  }

  Block block(std::uint64_t i) const { return philox(key_, i, 0); }
  static std::uint64_t mix(std::uint64_t key, std::uint64_t tag) { return philox(key, tag, 1).low; }

  std::uint64_t key_;
};

}  // namespace gust
