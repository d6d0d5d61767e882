#include "gust/nn/transpose.h"

#include <algorithm>

#include "gust/nn/vec.h"

namespace gust {
namespace {

/// Eight rows of eight floats become eight columns.
void transpose_square(const float* from, std::size_t from_stride, float* to, std::size_t to_stride) {
  using V = Vec<float>;
  V a[8];
  V b[8];
  for (std::size_t i = 0; i < 8; ++i) a[i] = load_as<V>(from + i * from_stride);
  for (std::size_t i = 0; i < 8; i += 2) {  // neighbours, within each half
    b[i] = __builtin_shufflevector(a[i], a[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    b[i + 1] = __builtin_shufflevector(a[i], a[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (std::size_t i = 0; i < 8; i += 4) {  // pairs
    for (std::size_t j = 0; j < 2; ++j) {
      a[i + 2 * j] = __builtin_shufflevector(b[i + j], b[i + j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      a[i + 2 * j + 1] = __builtin_shufflevector(b[i + j], b[i + j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {  // halves
    store_as<V>(to + i * to_stride, __builtin_shufflevector(a[i], a[i + 4], 0, 1, 2, 3, 8, 9, 10, 11));
    store_as<V>(to + (i + 4) * to_stride, __builtin_shufflevector(a[i], a[i + 4], 4, 5, 6, 7, 12, 13, 14, 15));
  }
}

}  // namespace

template <class T>
void transpose(const T* from, T* to, std::size_t rows, std::size_t columns) {
  std::size_t whole_rows = 0;
  std::size_t whole_columns = 0;
  if constexpr (sizeof(T) == sizeof(float)) {
    // Sixteen columns at a time, so that whole cache lines are read, and few are open where it is written.
    whole_rows = rows / 8 * 8;
    whole_columns = columns / 8 * 8;
    for (std::size_t first = 0; first < whole_columns; first += 16)
      for (std::size_t row = 0; row < whole_rows; row += 8)
        for (std::size_t column = first; column < std::min(first + 16, whole_columns); column += 8)
          transpose_square(from + row * columns + column, columns, to + column * rows + row, rows);
  }
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = row < whole_rows ? whole_columns : 0; column < columns; ++column)
      to[column * rows + row] = from[row * columns + column];
}

template void transpose(const float*, float*, std::size_t, std::size_t);
template void transpose(const double*, double*, std::size_t, std::size_t);

}  // namespace gust
