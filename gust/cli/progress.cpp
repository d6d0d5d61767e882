#include "gust/cli/progress.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>

#include "gust/cli/command.h"
#include "gust/cli/progress_text.h"

namespace gust {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kQuiet = 1.0;  // seconds before anything is shown
constexpr std::chrono::milliseconds kBetweenDrawings{100};

void write_error(std::string_view text) {
  // A terminal that takes nothing is no reason to stop, so what is not written is lost.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

bool is_terminal() {
  const char* kind = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && kind != nullptr && std::string_view(kind) != "dumb";
}

bool speaks_unicode() {
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(variable);
    if (value == nullptr || *value == '\0') continue;
    const std::string_view text = value;
    return text.find("UTF-8") != std::string_view::npos || text.find("utf8") != std::string_view::npos;
  }
  return false;
}

TerminalStyle terminal_style() {
  return {terminal_columns(STDERR_FILENO, 80), use_color(STDERR_FILENO), speaks_unicode()};
}

/// Draws now and then on a thread of its own, from its birth to its end.
class Display {
 public:
  explicit Display(const Progress& progress)
      : progress_(progress), terminal_(is_terminal()), thread_([this](std::stop_token stop) { draw(stop); }) {}

  ~Display() {
    thread_.request_stop();
    thread_.join();
    if (drawn_) write_error("\r\x1b[J");
  }

 private:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  void draw(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
      tick_.wait_for(lock, stop, kBetweenDrawings, [] { return false; });
      const Progress::Moment moment = progress_.now();
      left_.add(seconds(), moment.fraction);
      if (seconds() < kQuiet) continue;
      terminal_ ? draw_bar(moment) : draw_line(moment);
    }
  }

  void draw_bar(const Progress::Moment& moment) {
    const std::string bar = progress_bar(moment, left_.seconds(), terminal_style());
    write_error("\r\x1b[J" + bar + "\r\x1b[1A");  // the cursor rests at its start, so that other lines replace it
    drawn_ = true;
  }

  void draw_line(const Progress::Moment& moment) {
    const int tens = static_cast<int>(moment.fraction * 10 + 1e-9);
    if (tens <= tens_) return;
    tens_ = tens;
    write_error("gust: " + progress_line(moment, left_.seconds()) + "\n");
  }

  const Progress& progress_;
  const bool terminal_;
  const Clock::time_point start_ = Clock::now();
  TimeLeft left_;
  bool drawn_ = false;
  int tens_ = 0;
  std::mutex mutex_;
  std::condition_variable_any tick_;
  std::jthread thread_;  // last: what it uses is there before it and after it
};

}  // namespace

void show_progress(const Progress& progress, const std::function<void()>& work) {
  std::optional<Display> display;
  try {
    display.emplace(progress);
  } catch (const std::system_error&) {  // no thread for it: the work goes on unseen
  }
  work();
}

}  // namespace gust
