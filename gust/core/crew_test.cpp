#include "gust/core/crew.h"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "gust/core/error.h"
#include "gust/core/text.h"

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

TEST_CASE("every item is done once, and the error of the lowest that failed is thrown after all are done") {
  for (const std::size_t threads : {1, 3}) {
    std::vector<std::atomic<int>> done(100);
    const auto work = [&] {
      return [&](std::size_t item) {
        ++done[item];
        if (item == 40 || item == 70) throw Error(cat("item ", item));
      };
    };

    CHECK_THROWS_WITH_AS(for_each_item(threads, done.size(), work), "item 40", Error);
    for (const std::atomic<int>& times : done) CHECK(times == 1);
  }
}
