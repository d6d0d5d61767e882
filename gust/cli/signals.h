#pragma once

#include <atomic>
#include <stop_token>
#include <thread>

namespace gust {

/// Turns SIGINT and SIGTERM into a request to stop, as long as it lives. A second signal ends the program at once.
///
/// Where no thread can be had for it, they end the program at once.
///
/// Make it before any other thread: the signals are blocked in this thread and those that it starts, and taken by a
/// thread of its own, so no code runs inside a signal handler.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  std::stop_token token() const { return source_.get_token(); }
  /// kInterrupted after SIGINT, kTerminated after SIGTERM, kDone if there was none.
  int exit_code() const { return exit_code_.load(); }

 private:
  void watch(int signals, int end);

  std::stop_source source_;
  std::atomic<int> exit_code_;
  int end_ = -1;  ///< an event that ends the thread
  std::jthread thread_;
};

/// From now on SIGINT and SIGTERM end the program at once with kInterrupted and kTerminated, where nobody ignores them.
void end_at_signals();

/// Blocks both in this thread, so that they come to the others.
void leave_signals_to_others();

}  // namespace gust
