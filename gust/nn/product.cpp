#include "gust/nn/product.h"

#include <libxsmm.h>

#include <cstddef>

#include "gust/nn/vec.h"

namespace gust {
namespace {

/// Whether libxsmm 1.17 adds up in order. With AVX-512 it cuts the sum over k into several when a block of rows is one
/// register wide, that is, when m or what is left of m after whole blocks of 64 rows is 1 … 16 (seen over all m and n
/// up to 256; product_test.cpp compares the bits).
bool adds_in_order(int m) { return m % 64 == 0 || m % 64 > 16; }

void (*compile(const ProductShape& shape))(const float*, const float*, float*, ...) {
  if (!adds_in_order(shape.m)) return nullptr;
  const int ldb = shape.b_transposed ? shape.n : shape.k;
  const float alpha = 1.0f;
  const float beta = shape.accumulate ? 1.0f : 0.0f;
  const int flags = shape.b_transposed ? LIBXSMM_GEMM_FLAG_TRANS_B : LIBXSMM_GEMM_FLAG_NONE;
  return libxsmm_smmdispatch(shape.m, shape.n, shape.k, &shape.m, &ldb, &shape.m, &alpha, &beta, &flags, nullptr);
}

/// V rows times kColumns columns of C, held in registers; V is a scalar or a vector.
template <class V, int kColumns, class T>
void tile(const ProductShape& s, const T* a, const T* b, T* c) {
  const std::ptrdiff_t m = s.m;
  const std::ptrdiff_t next_k = s.b_transposed ? s.n : 1;
  const std::ptrdiff_t next_column = s.b_transposed ? 1 : s.k;
  V sum[kColumns];
  for (int j = 0; j < kColumns; ++j) sum[j] = s.accumulate ? load_as<V>(c + j * m) : V{};
  for (int k = 0; k < s.k; ++k) {
    const V column = load_as<V>(a + k * m);
    for (int j = 0; j < kColumns; ++j) sum[j] = fused(column, V{} + b[k * next_k + j * next_column], sum[j]);
  }
  for (int j = 0; j < kColumns; ++j) store_as(c + j * m, sum[j]);
}

/// V rows times all columns.
template <class V, class T>
void strip(const ProductShape& s, const T* a, const T* b, T* c) {
  const std::ptrdiff_t next_column = s.b_transposed ? 1 : s.k;
  int j = 0;
  for (; j + 8 <= s.n; j += 8) tile<V, 8>(s, a, b + j * next_column, c + std::ptrdiff_t{j} * s.m);
  for (; j < s.n; ++j) tile<V, 1>(s, a, b + j * next_column, c + std::ptrdiff_t{j} * s.m);
}

}  // namespace

template <class T>
Product<T>::Product(ProductShape shape) : shape_(shape) {
  if constexpr (sizeof(T) == sizeof(float)) compiled_ = compile(shape);
}

template <class T>
void Product<T>::plain(const T* a, const T* b, T* c) const noexcept {
  constexpr int kWidth = static_cast<int>(kVecWidth<T>);
  int i = 0;
  for (; i + kWidth <= shape_.m; i += kWidth) strip<Vec<T>>(shape_, a + i, b, c + i);
  for (; i < shape_.m; ++i) strip<T>(shape_, a + i, b, c + i);
}

template class Product<float>;
template class Product<double>;

}  // namespace gust
