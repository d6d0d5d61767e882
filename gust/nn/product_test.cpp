#include "gust/nn/product.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "gust/core/rng.h"

using namespace gust;

namespace {

template <class T>
std::vector<T> draws(std::size_t count, Rng rng) {
  std::vector<T> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<T>(rng.normal(i));
  return values;
}

/// The definition: every element one chain of fused multiply-adds.
template <class T>
void multiply(const ProductShape& s, const std::vector<T>& a, const std::vector<T>& b, std::vector<T>& c) {
  for (int j = 0; j < s.n; ++j) {
    for (int i = 0; i < s.m; ++i) {
      T sum = s.accumulate ? c[j * s.m + i] : T(0);
      for (int k = 0; k < s.k; ++k) sum = std::fma(a[k * s.m + i], b[s.b_transposed ? k * s.n + j : j * s.k + k], sum);
      c[j * s.m + i] = sum;
    }
  }
}

template <class T>
bool equals_definition(const ProductShape& shape) {
  const Rng rng = Rng(3).split(shape.m * 1000000 + shape.n * 1000 + shape.k);
  const auto a = draws<T>(shape.m * shape.k, rng.split("a"));
  const auto b = draws<T>(shape.k * shape.n, rng.split("b"));
  auto expected = draws<T>(shape.m * shape.n, rng.split("c"));
  auto fast = expected;
  auto plain = expected;
  const Product<T> product(shape);
  multiply(shape, a, b, expected);
  product(a.data(), b.data(), fast.data());
  product.plain(a.data(), b.data(), plain.data());
  return fast == expected && plain == expected;
}

}  // namespace

TEST_CASE("a product adds up in order, to the bit, whatever its shape") {
  for (const int m : {1, 3, 8, 16, 17, 24, 32, 48, 63, 64, 65, 80, 81, 100, 128, 200, 256}) {
    for (const int n : {1, 2, 4, 5, 12, 16, 64}) {
      for (const int k : {1, 4, 16, 64}) {
        for (const bool b_transposed : {false, true}) {
          for (const bool accumulate : {false, true}) {
            const ProductShape shape = {m, n, k, b_transposed, accumulate};
            CAPTURE(m);
            CAPTURE(n);
            CAPTURE(k);
            CHECK(equals_definition<float>(shape));
          }
        }
      }
    }
  }
}

TEST_CASE("a product in double adds up in order too") {
  CHECK(equals_definition<double>({7, 9, 6, false, false}));
  CHECK(equals_definition<double>({6, 5, 9, true, true}));
  CHECK(equals_definition<double>({64, 16, 64, false, true}));
}

TEST_CASE("the products of tiles add up in order, and run compiled whatever the width of the layer") {
  for (const int width : {1, 2, 5, 17, 32, 100, 256}) {
    for (const bool b_transposed : {false, true}) {
      CHECK(equals_definition<float>({64, width, 256, b_transposed}));
      CHECK(equals_definition<float>({64, 256, width, b_transposed}));
      CHECK(Product<float>({64, width, 256, b_transposed}).compiled());
    }
    CHECK(equals_definition<float>({256, width, 64, false, true}));
  }
}

TEST_CASE("the layers of common networks run compiled") {
  for (const int width : {24, 32, 64, 100, 128, 256}) CHECK(Product<float>({.m = width, .n = 64, .k = 64}).compiled());
}
