#pragma once

#include <cstddef>

namespace gust {

/// to (columns x rows) = from (rows x columns) transposed; the numbers of a row lie side by side, rows without gaps.
template <class T>
void transpose(const T* from, T* to, std::size_t rows, std::size_t columns);

}  // namespace gust
