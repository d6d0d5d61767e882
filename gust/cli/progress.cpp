#include "gust/cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <thread>

#include "gust/cli/command.h"
#include "gust/core/text.h"

namespace gust {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kQuiet = 1.0;    // seconds before anything is shown
constexpr double kRecent = 20.0;  // seconds of the past that make the pace, or half of all if that is more
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
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return {known ? size.ws_col : std::size_t{80}, use_color(STDERR_FILENO), speaks_unicode()};
}

/// At most `width` characters of a text, with "..." at the end if it was longer, and nothing that moves the cursor.
std::string fitted(std::string_view text, std::size_t width) {
  std::string out;
  std::size_t characters = 0;
  std::size_t last_place = 0;  // where to cut, so that the dots fit
  for (const char c : text) {
    const bool continues = (static_cast<unsigned char>(c) & 0xC0) == 0x80;
    if (!continues && characters + 3 == width) last_place = out.size();
    if (!continues && ++characters > width)
      return out.substr(0, last_place) + std::string(std::min<std::size_t>(width, 3), '.');
    const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
    out += control ? '?' : c;
  }
  return out;
}

std::string repeated(std::string_view piece, std::size_t times) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += piece;
  return out;
}

std::string painted(std::string_view text, std::string_view code, const TerminalStyle& style) {
  return style.color ? fmt::format("\x1b[{}m{}\x1b[0m", code, text) : std::string(text);
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
  const Display display(progress);
  work();
}

void TimeLeft::add(double seconds, double fraction) {
  past_.emplace_back(seconds, fraction);
  const double oldest = seconds - std::max(kRecent, seconds / 2);
  while (past_.size() > 2 && past_[1].first < oldest) past_.pop_front();
}

std::optional<double> TimeLeft::seconds() const {
  if (past_.size() < 2) return std::nullopt;
  const auto& [first_seconds, first] = past_.front();
  const auto& [last_seconds, last] = past_.back();
  if (!(last > first) || !(last_seconds > first_seconds)) return std::nullopt;
  return (1 - last) * (last_seconds - first_seconds) / (last - first);
}

std::string progress_bar(const Progress::Moment& moment, std::optional<double> left, const TerminalStyle& style) {
  const std::string text = fmt::format(" {:3.0f} %  {}/{} trials  {} left", std::floor(moment.fraction * 100),
                                       moment.finished, moment.jobs, left ? clock_text(*left) : "?");
  const std::size_t room = style.width > text.size() ? std::min<std::size_t>(style.width - text.size(), 40) : 0;
  const auto full = static_cast<std::size_t>(moment.fraction * static_cast<double>(room));
  const std::string done = repeated(style.unicode ? "━" : "#", full);
  const std::string open = repeated(style.unicode ? "─" : "-", room - full);
  const std::string running = fitted(join(moment.running, ", "), style.width);
  return painted(done, "36", style) + painted(open, "2", style) + fitted(text, style.width) + "\n" +
         painted(running, "2", style);
}

std::string progress_line(const Progress::Moment& moment, std::optional<double> left) {
  const std::string time = left ? fmt::format(", {} left", clock_text(*left)) : "";
  return fmt::format("{:.0f} %, {} of {} trials{}", std::floor(moment.fraction * 100 + 1e-9), moment.finished,
                     moment.jobs, time);
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 3.6e6)));
  const long long hours = whole / 3600;
  const long long minutes = whole / 60 % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
  return fmt::format("{}:{:02}", minutes, whole % 60);
}

}  // namespace gust
