#include "gust/core/crew.h"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>

using namespace gust;

TEST_CASE("a crew does its work once on each thread, and an error of one is thrown after all have ended") {
  std::atomic<int> begun = 0, ended = 0;
  const auto work = [&] {
    if (++begun == 2) throw std::runtime_error("second");
    ++ended;
  };

  CHECK_THROWS_WITH(run_crew(4, work), "second");

  CHECK(begun == 4);
  CHECK(ended == 3);
}
