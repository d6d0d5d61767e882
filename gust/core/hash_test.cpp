#include "gust/core/hash.h"

#include <doctest/doctest.h>

using namespace gust;

TEST_CASE("hashes are those of the reference implementation of XXH3, 128 bits") {
  // xxhash.xxh3_128_hexdigest of the Python package xxhash 3.
  std::string bytes;
  for (int i = 0; i < 5 * 256; ++i) bytes += static_cast<char>(i % 256);

  CHECK(hash_hex("") == "99aa06d3014798d86001c324468d497f");
  CHECK(hash_hex("a") == "a96faf705af16834e6c632b61e964e1f");
  CHECK(hash_hex("cartpole(pole_length = 0.5)") == "8d2a9726c9be7c892bc57b7c199e73c5");
  CHECK(hash_hex(bytes) == "d92ab3a1cb0542a74844b009e164352e");
}

TEST_CASE("one bit changes the hash") {
  CHECK(hash_hex("cartpole(pole_length = 0.4)") != hash_hex("cartpole(pole_length = 0.5)"));
}
