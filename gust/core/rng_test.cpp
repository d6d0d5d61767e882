#include "gust/core/rng.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <span>

using namespace gust;

namespace {

using Philox = r123::Philox4x32;

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  const Philox::ctr_type c = {{counter[0], counter[1], counter[2], counter[3]}};
  const Philox::key_type k = {{key[0], key[1]}};
  const Philox::ctr_type out = Philox{}(c, k);
  return {out[0], out[1], out[2], out[3]};
}

/// Two words of the block that a stream of 64-bit key reads at a counter.
std::array<std::uint64_t, 2> block(std::uint64_t key, std::uint64_t counter, std::uint64_t kind) {
  const auto low = [](std::uint64_t value) { return static_cast<std::uint32_t>(value); };
  const auto high = [](std::uint64_t value) { return static_cast<std::uint32_t>(value >> 32); };
  const auto out = philox({low(counter), high(counter), low(kind), high(kind)}, {low(key), high(key)});
  return {out[0] | std::uint64_t{out[1]} << 32, out[2] | std::uint64_t{out[3]} << 32};
}

}  // namespace

TEST_CASE("the generator gives the known answers of Random123's Philox4x32-10") {
  // kat_vectors of Random123 1.14, lines "philox4x32 10".
  CHECK(philox({0, 0, 0, 0}, {0, 0}) == std::array<std::uint32_t, 4>{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  CHECK(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
        std::array<std::uint32_t, 4>{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
        std::array<std::uint32_t, 4>{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("a stream is Philox keyed by its seed, counted by the index") {
  const std::uint64_t seed = 0x0123456789abcdef;
  const std::uint64_t own = block(seed, 0x6775737400000000, 1)[0];  // "gust" in ASCII
  const Rng rng(seed);

  CHECK(rng.bits(0) == block(own, 0, 0)[0]);
  CHECK(rng.bits(7) == block(own, 7, 0)[0]);
  CHECK(rng.bits(std::uint64_t{1} << 40) == block(own, std::uint64_t{1} << 40, 0)[0]);
  CHECK(rng.split(3).bits(5) == block(block(own, 3, 1)[0], 5, 0)[0]);
}

TEST_CASE("a number of a stream does not depend on which others were drawn") {
  const Rng rng(42);
  const double alone = rng.normal(1000);

  for (std::uint64_t i = 0; i < 1000; ++i) (void)rng.normal(i);
  (void)rng.split("other").uniform(1000);

  CHECK(rng.normal(1000) == alone);
  CHECK(Rng(42).normal(1000) == alone);
}

TEST_CASE("uniform numbers lie in [0, 1) and have the moments of the uniform distribution") {
  const Rng rng(1);
  constexpr int kCount = 1'000'000;
  double sum = 0, squares = 0, neighbours = 0;
  int outside = 0;

  double last = rng.uniform(kCount);
  for (int i = 0; i < kCount; ++i) {
    const double u = rng.uniform(static_cast<std::uint64_t>(i));
    outside += u >= 0.0 && u < 1.0 ? 0 : 1;
    sum += u;
    squares += u * u;
    neighbours += (u - 0.5) * (last - 0.5);
    last = u;
  }

  CHECK(outside == 0);
  // Five standard errors of each estimate.
  CHECK(std::abs(sum / kCount - 1.0 / 2) < 5 * std::sqrt(1.0 / 12 / kCount));
  CHECK(std::abs(squares / kCount - 1.0 / 3) < 5 * std::sqrt(4.0 / 45 / kCount));
  CHECK(std::abs(neighbours / kCount) < 5 * (1.0 / 12) / std::sqrt(kCount));
}

TEST_CASE("normal numbers have the first four moments and the tails of the normal distribution") {
  const Rng rng(2);
  constexpr int kCount = 1'000'000;
  double moments[5] = {};
  int beyond_two = 0;

  for (int i = 0; i < kCount; ++i) {
    const double z = rng.normal(static_cast<std::uint64_t>(i));
    double power = 1;
    for (double& moment : moments) {
      moment += power / kCount;
      power *= z;
    }
    beyond_two += std::abs(z) > 2 ? 1 : 0;
  }

  // Five standard errors: the variances of z, z^2, z^3 and z^4 are 1, 2, 15 and 96.
  const double unit = 5 / std::sqrt(kCount);
  CHECK(std::abs(moments[1]) < unit * std::sqrt(1.0));
  CHECK(std::abs(moments[2] - 1) < unit * std::sqrt(2.0));
  CHECK(std::abs(moments[3]) < unit * std::sqrt(15.0));
  CHECK(std::abs(moments[4] - 3) < unit * std::sqrt(96.0));
  const double two_sided = 0.045500263896358;  // 2 (1 - Phi(2))
  CHECK(std::abs(beyond_two / static_cast<double>(kCount) - two_sided) < unit * std::sqrt(two_sided));
}

TEST_CASE("whole numbers below n are even over 0 to n - 1") {
  const Rng rng(3);
  constexpr int kCount = 300'000;
  int counts[7] = {};

  for (int i = 0; i < kCount; ++i) {
    const std::uint64_t number = rng.below(6, static_cast<std::uint64_t>(i));
    ++counts[std::min<std::uint64_t>(number, 6)];
  }

  CHECK(counts[6] == 0);
  double chi_square = 0;
  for (const int count : std::span(counts).first(6))
    chi_square += (count - kCount / 6.0) * (count - kCount / 6.0) / (kCount / 6.0);
  CHECK(chi_square < 20.5);  // 0.1 % quantile of five degrees of freedom
  CHECK(rng.below(1, 5) == 0);
  CHECK(rng.below(~std::uint64_t{0}, 5) <= rng.bits(5));
}

TEST_CASE("streams that are split by number, by name or by path are distinct and independent") {
  const Rng rng(4);
  std::set<std::uint64_t> firsts = {rng.bits(0)};

  for (std::uint64_t i = 0; i < 1000; ++i) firsts.insert(rng.split(i).bits(0));
  for (const char* name : {"", "a", "b", "ab", "ba", "action", "observation", "dynamics"}) {
    firsts.insert(rng.split(name).bits(0));
    firsts.insert(rng.split(name).split(0).bits(0));
    firsts.insert(rng.split(0).split(name).bits(0));
  }
  for (std::uint64_t seed = 5; seed < 1000; ++seed) firsts.insert(Rng(seed).bits(0));

  CHECK(firsts.size() == 1 + 1000 + 3 * 8 + 995);
}

TEST_CASE("neighbouring streams are not correlated") {
  const Rng rng(5);
  constexpr int kCount = 200'000;
  const Rng a = rng.split(0);
  const Rng b = rng.split(1);
  const Rng c = rng.split("noise");
  double ab = 0, ac = 0;

  for (int i = 0; i < kCount; ++i) {
    const auto index = static_cast<std::uint64_t>(i);
    ab += a.normal(index) * b.normal(index) / kCount;
    ac += a.normal(index) * c.normal(index) / kCount;
  }

  CHECK(std::abs(ab) < 5 / std::sqrt(kCount));
  CHECK(std::abs(ac) < 5 / std::sqrt(kCount));
}
