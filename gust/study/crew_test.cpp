#include "gust/study/crew.h"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

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

TEST_CASE("without memory for more threads the work is done on those that there are") {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit none{std::size_t{1} << 20, std::size_t{1} << 20};
    setrlimit(RLIMIT_AS, &none);
    std::atomic<int> done = 0;
    run_crew(4, [&] { ++done; });
    _exit(done >= 1 ? 0 : 1);  // stacks of earlier threads may be at hand
  }
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(status == 0);
}
