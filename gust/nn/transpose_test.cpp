#include "gust/nn/transpose.h"

#include <doctest/doctest.h>

#include <numeric>
#include <vector>

using namespace gust;

TEST_CASE_TEMPLATE("rows become columns, whatever their numbers", T, float, double) {
  for (const std::size_t rows : {1u, 7u, 8u, 64u, 67u}) {
    for (const std::size_t columns : {1u, 5u, 8u, 64u, 100u}) {
      std::vector<T> from(rows * columns), to(rows * columns);
      std::iota(from.begin(), from.end(), T(0));

      transpose(from.data(), to.data(), rows, columns);

      bool equal = true;
      for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column)
          equal = equal && to[column * rows + row] == from[row * columns + column];
      CHECK(equal);
    }
  }
}
