#include "gust/cli/progress_text.h"

#include <doctest/doctest.h>

#include <algorithm>

using namespace gust;

namespace {

Progress::Moment sample() {
  Progress::Moment moment;
  moment.fraction = 0.5;
  moment.finished = 12;
  moment.jobs = 40;
  moment.running = {"train ppo 1", "ppo 2: action step"};
  return moment;
}

/// Characters of the longest line.
std::ptrdiff_t width_of(const std::string& text) {
  std::ptrdiff_t longest = 0;
  std::ptrdiff_t width = 0;
  for (const char c : text) {
    width = c == '\n' ? 0 : width + ((static_cast<unsigned char>(c) & 0xC0) != 0x80 ? 1 : 0);
    longest = std::max(longest, width);
  }
  return longest;
}

}  // namespace

TEST_CASE("the bar shows the share that is done, the trials, the time left, and what runs") {
  const std::string bar = progress_bar(sample(), 75.0, {});

  CHECK(bar ==
        "####################--------------------  50 %  12/40 trials  1:15 left\n"
        "train ppo 1, ppo 2: action step");
}

TEST_CASE("the bar is never wider than the terminal, in any alphabet") {
  Progress::Moment moment = sample();
  moment.running = {std::string(300, 'x'), "ü"};
  for (std::size_t i = 0; i < 30; ++i) moment.running.front() += "ü";

  for (std::size_t width = 1; width < 200; ++width) {
    CHECK(width_of(progress_bar(moment, 10.0, {.width = width, .color = false, .unicode = true})) <=
          static_cast<std::ptrdiff_t>(width));
  }
  moment.running = {"äöü", std::string(30, 'y')};
  CHECK(progress_bar(moment, 10.0, {.width = 10}).ends_with("\näöü, yy..."));
}

TEST_CASE("a name cannot move the cursor, and colours are only where they are wanted") {
  Progress::Moment moment = sample();
  moment.running = {"a\x1b[2Jb\nc"};

  const std::string plain = progress_bar(moment, {}, {});
  const std::string colored = progress_bar(moment, {}, {.color = true, .unicode = true});

  CHECK(plain.ends_with("? left\na?[2Jb?c"));
  CHECK(plain.find('\x1b') == std::string::npos);
  CHECK(colored.starts_with("\x1b[36m━"));
  CHECK(colored.ends_with("\x1b[0m"));
}

TEST_CASE("the line for a file says the same without a bar") {
  CHECK(progress_line(sample(), 75.0) == "50 %, 12 of 40 trials, 1:15 left");
  CHECK(progress_line(sample(), {}) == "50 %, 12 of 40 trials");
}

TEST_CASE("the time left follows the recent pace") {
  TimeLeft left;
  CHECK(!left.seconds());

  left.add(0, 0.5);  // a resumed run begins in the middle
  CHECK(!left.seconds());
  left.add(1, 0.5);
  CHECK(!left.seconds());
  left.add(10, 0.75);
  CHECK(left.seconds() == doctest::Approx(10).epsilon(1e-12));
  for (int second = 11; second <= 60; ++second) left.add(second, 0.75 + 0.001 * second);
  CHECK(left.seconds() == doctest::Approx((0.25 - 0.06) / 0.001).epsilon(1e-9));
}

TEST_CASE("a clock counts hours only when there are any") {
  CHECK(clock_text(0) == "0:00");
  CHECK(clock_text(0.2) == "0:01");
  CHECK(clock_text(75) == "1:15");
  CHECK(clock_text(7384) == "2:03:04");
  CHECK(clock_text(1e300) == "1000:00:00");
}
