#include "gust/cli/text_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/epoll.h>

#include <cctype>
#include <cstdio>

#include "gust/core/error.h"

namespace gust {
namespace {

/// How many bytes from here on are one control character: of ASCII, or one of U+0080 to U+009F in UTF-8.
std::size_t control_bytes(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  if (byte(0) < 0x20 || byte(0) == 0x7f) return 1;
  return byte(0) == 0xc2 && byte(1) >= 0x80 && byte(1) < 0xa0 ? 2 : 0;
}

}  // namespace

std::string printable(std::string_view text, std::string_view kept) {
  std::string plain;
  while (!text.empty()) {
    const std::size_t control = kept.find(text.front()) == kept.npos ? control_bytes(text) : 0;
    if (control == 0) plain += text.front();
    if (control > 0) plain += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[control - 1]));
    text.remove_prefix(control == 2 ? 2 : 1);
  }
  return plain;
}

std::string shortened(std::string_view message) {
  constexpr std::size_t kMost = 200;
  std::string text;
  std::size_t length = 0;  // of the word or the quotation at hand
  bool quoted = false;
  for (std::size_t i = 0; i < message.size(); ++i) {
    const char c = message[i];
    const bool opens =
        c == '\'' && !quoted && (i == 0 || std::isalnum(static_cast<unsigned char>(message[i - 1])) == 0);
    const bool ends = quoted ? c == '\'' : c == ' ' || c == '\n' || opens;
    if (opens || (quoted && ends)) quoted = opens;
    if (opens || ends) length = 0;
    const bool inside_character = (static_cast<unsigned char>(c) & 0xc0) == 0x80;  // of UTF-8
    length += opens || ends || inside_character ? 0 : 1;
    if (length <= kMost) text += c;
    if (length == kMost + 1 && !inside_character) text += "...";
    if (length > kMost) length = kMost + 2;
  }
  return text;
}

void tell(std::string_view text) {
  const std::string line = "gust: " + printable(shortened(text)) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

bool print_result(std::string_view text, std::string_view where) {
  const std::string lines = printable(text, "\n");
  const bool taken = std::fwrite(lines.data(), 1, lines.size(), stdout) == lines.size() && std::fflush(stdout) == 0;
  if (!taken) tell(cat("standard output: cannot be written to; ", where));
  return taken;
}

void print_lines(std::string_view text) { fmt::print("{}", printable(text, "\n")); }

void hold_standard_files() {
  for (int number = 0; number <= 2; ++number) {
    if (::fcntl(number, F_GETFD) < 0) ::epoll_create1(0);  // what is written to it still fails, unlike to /dev/null
  }
}

}  // namespace gust
