#include "gust/cli/signals.h"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>

#include "gust/cli/command.h"

using namespace gust;

namespace {

/// The exit code of a process of its own that does this.
int exit_code_of(const std::function<int()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(STDERR_FILENO);
    ::signal(SIGTERM, SIG_DFL);  // doctest has its own handler
    ::alarm(60);                 // a test that hangs dies
    ::_exit(work());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

void wait_for_stop(const SignalWatch& signals) {
  while (!signals.token().stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

int stop_by(int signal) {
  return exit_code_of([signal] {
    const SignalWatch signals;
    ::kill(::getpid(), signal);
    wait_for_stop(signals);
    return signals.exit_code();
  });
}

/// Sends a second signal to a process that never heeds the first.
int stop_stubborn_by(int first, int second) {
  return exit_code_of([first, second] {
    const SignalWatch signals;
    ::kill(::getpid(), first);
    wait_for_stop(signals);
    ::kill(::getpid(), second);
    std::this_thread::sleep_for(std::chrono::seconds(50));
    return 99;
  });
}

}  // namespace

TEST_CASE("the first signal asks to stop and decides the exit code") {
  CHECK(stop_by(SIGINT) == kInterrupted);
  CHECK(stop_by(SIGTERM) == kTerminated);
}

TEST_CASE("the second signal ends the program at once") {
  CHECK(stop_stubborn_by(SIGINT, SIGINT) == kInterrupted);
  CHECK(stop_stubborn_by(SIGTERM, SIGTERM) == kTerminated);
  CHECK(stop_stubborn_by(SIGTERM, SIGINT) == kInterrupted);
  CHECK(stop_stubborn_by(SIGINT, SIGTERM) == kInterrupted);
}

TEST_CASE("without a signal nothing is stopped, and afterwards signals do what they always did") {
  CHECK(exit_code_of([] {
          const SignalWatch signals;
          return signals.token().stop_requested() ? 99 : signals.exit_code();
        }) == kDone);
  CHECK(exit_code_of([] {
          { const SignalWatch signals; }
          ::kill(::getpid(), SIGTERM);
          return 99;
        }) == -SIGTERM);
}
