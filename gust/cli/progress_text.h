#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "gust/study/trials/executor.h"

namespace gust {

/// Guesses the seconds that are left from the recent pace.
class TimeLeft {
 public:
  /// The share of the work that is done, 0 to 1, so many seconds after the start.
  void add(double seconds, double fraction);
  /// Nothing while there is no pace to go by.
  std::optional<double> seconds() const;

 private:
  std::deque<std::pair<double, double>> past_;
};

/// What the terminal can show.
struct TerminalStyle {
  std::size_t width = 80;
  bool color = false;
  bool unicode = false;
};

/// At most `width` characters of a text, with "..." at the end if it was longer, and nothing that moves the cursor.
std::string fitted(std::string_view text, std::size_t width);

/// The two lines of the bar, without a line break after the second, no wider than the terminal.
std::string progress_bar(const Progress::Moment& moment, std::optional<double> left, const TerminalStyle& style);

/// The line for where there is no terminal: "30 %, 12 of 40 trials, 0:21 left".
std::string progress_line(const Progress::Moment& moment, std::optional<double> left);

/// "0:07", "12:30", "2:03:04".
std::string clock_text(double seconds);

}  // namespace gust
