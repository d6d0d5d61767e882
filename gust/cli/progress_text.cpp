#include "gust/cli/progress_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "gust/core/text.h"

namespace gust {
namespace {

constexpr double kRecent = 20.0;  // seconds of the past that make the pace, or half of all if that is more

std::string repeated(std::string_view piece, std::size_t times) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += piece;
  return out;
}

std::string painted(std::string_view text, std::string_view code, const TerminalStyle& style) {
  return style.color ? fmt::format("\x1b[{}m{}\x1b[0m", code, text) : std::string(text);
}

}  // namespace

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
