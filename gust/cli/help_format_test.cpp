#include "gust/cli/help_format.h"

#include <doctest/doctest.h>

namespace gust {
namespace {

TEST_CASE("text is wrapped at spaces, and only where it is too long") {
  CHECK(wrapped("one two three", 7) == "one two\nthree");
  CHECK(wrapped("one two three", 13) == "one two three");
  CHECK(wrapped("one two three", 12, 2) == "one two\n  three");
  CHECK(wrapped("a\n\nb c", 3) == "a\n\nb c");
}

TEST_CASE("a word that is longer than the line stays whole, and examples stay as they are") {
  CHECK(wrapped("incomprehensible it is", 6) == "incomprehensible\nit is");
  CHECK(wrapped("  gust eval lqr --plant cartpole", 10) == "  gust eval lqr --plant cartpole");
  CHECK(wrapped("", 10) == "");
}

}  // namespace
}  // namespace gust
