#include "gust/cli/signals.h"

#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <string>
#include <system_error>

#include "gust/cli/command.h"
#include "gust/core/error.h"

namespace gust {
namespace {

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

/// Writes to stderr, in the place of a progress bar if there is one. Nobody may be listening.
void say(std::string text) {
  if (isatty(STDERR_FILENO) != 0) text.insert(0, "\r\x1b[J");
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

int code_of(std::uint32_t signal) { return signal == SIGINT ? kInterrupted : kTerminated; }

}  // namespace

SignalWatch::SignalWatch() : exit_code_(kDone) {
  const sigset_t set = watched_signals();
  GUST_CHECK(pthread_sigmask(SIG_BLOCK, &set, nullptr) == 0);
  const int signals = signalfd(-1, &set, SFD_CLOEXEC);
  end_ = eventfd(0, EFD_CLOEXEC);
  try {
    if (signals >= 0 && end_ >= 0) thread_ = std::jthread([this, signals] { watch(signals, end_); });
  } catch (const std::system_error&) {
  }
  if (thread_.joinable()) return;
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);  // no thread or descriptor is left: a signal ends the program at once
  if (signals >= 0) ::close(signals);
}

void end_at_signals() {
  struct sigaction action {};
  action.sa_handler = [](int signal) { ::_exit(code_of(static_cast<std::uint32_t>(signal))); };
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction before {};
    if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_DFL)
      ::sigaction(signal, &action, nullptr);
  }
}

void leave_signals_to_others() {
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

SignalWatch::~SignalWatch() {
  if (!thread_.joinable()) {
    if (end_ >= 0) ::close(end_);
    return;
  }
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(end_, &one, sizeof one);
  thread_.join();
  ::close(end_);
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

void SignalWatch::watch(int signals, int end) {
  std::array<pollfd, 2> either = {pollfd{signals, POLLIN, 0}, pollfd{end, POLLIN, 0}};
  while ((either[1].revents & POLLIN) == 0) {
    if (::poll(either.data(), either.size(), -1) < 0 || (either[0].revents & POLLIN) == 0) continue;
    signalfd_siginfo info{};
    if (::read(signals, &info, sizeof info) != sizeof info) continue;
    const int code = code_of(info.ssi_signo);
    int before = kDone;
    if (!exit_code_.compare_exchange_strong(before, code)) {
      ::_exit(before == kInterrupted ? kInterrupted : code);
    }
    say("gust: stopping; once more to leave at once\n");
    source_.request_stop();
  }
  ::close(signals);
}

}  // namespace gust
