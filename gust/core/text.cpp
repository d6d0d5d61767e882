#include "gust/core/text.h"

#include <algorithm>
#include <cctype>
#include <numeric>

#include "gust/core/error.h"

namespace gust {
namespace {

/// Edits from one text to the other: insertions, deletions, substitutions, and two neighbours that change places
/// (optimal string alignment, Damerau 1964).
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last;
  std::vector<std::size_t> last(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::vector<std::size_t> row(b.size() + 1, i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({last[j + 1] + 1, row[j] + 1, last[j] + (a[i] == b[j] ? 0 : 1)});
      const bool swapped = i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j];
      if (swapped) row[j + 1] = std::min(row[j + 1], before_last[j - 1] + 1);
    }
    before_last = std::move(last);
    last = std::move(row);
  }
  return last.back();
}

/// The encoding that a byte order mark, or a zero byte in the first letter, tells of; empty if none does.
std::string_view wide_encoding(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\xff\xfe\0\0"sv) || bytes.starts_with("\0\0\xfe\xff"sv)) return "UTF-32";
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff")) return "UTF-16";
  return bytes.size() > 1 && (bytes[0] == '\0') != (bytes[1] == '\0') ? "UTF-16" : "";
}

/// The last space that leaves at most `width` columns before it, else the first one; npos if there is none.
std::size_t break_of(std::string_view line, std::size_t width) {
  std::size_t best = std::string_view::npos;
  for (std::size_t at = line.find(' '); at != std::string_view::npos; at = line.find(' ', at + 1)) {
    if (best != std::string_view::npos && text_width(line.substr(0, at)) > width) break;
    best = at;
  }
  return best;
}

void append_wrapped(std::string& to, std::string_view line, std::size_t width, std::size_t indent) {
  const bool as_it_is = line.starts_with(' ');
  while (!as_it_is && text_width(line) > width) {
    const std::size_t end = break_of(line, width);
    if (end == std::string_view::npos) break;
    to.append(line.substr(0, end)).append("\n").append(indent, ' ');
    line.remove_prefix(end + 1);
  }
  to.append(line);
}

char lower(char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter; }

}  // namespace

std::string_view utf8_text(std::string_view bytes, std::string_view name) {
  if (const std::string_view encoding = wide_encoding(bytes); !encoding.empty())
    throw Error(cat(name, ":1:1: is ", encoding, "; save it as UTF-8"));
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  return bytes;
}

std::string nearest(std::string_view typed, std::span<const std::string> candidates) {
  constexpr std::size_t kLongestName = 64;  // nobody means a name by a text longer than this
  if (typed.empty() || typed.size() > kLongestName) return {};
  for (const std::string& candidate : candidates) {
    if (std::ranges::equal(typed, candidate, {}, lower, lower)) return candidate;
  }
  const std::string* best = nullptr;
  std::size_t least = std::max<std::size_t>(1, typed.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edits(typed, candidate);
    if (distance < least) {
      least = distance;
      best = &candidate;
    }
  }
  return best ? *best : std::string{};
}

std::string did_you_mean(std::string_view typed, std::span<const std::string> candidates) {
  const std::string name = nearest(typed, candidates);
  return name.empty() ? name : cat("; did you mean '", name, "'?");
}

std::string join(std::span<const std::string> parts, std::string_view separator) {
  std::string text;
  for (const std::string& part : parts) {
    if (!text.empty()) text += separator;
    text += part;
  }
  return text;
}

std::vector<std::string> split_text(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    parts.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

std::string slug(std::string_view text, std::size_t most) {
  std::string result;
  for (const char letter : text) {
    if ((letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9')) {
      result += letter;
    } else if (letter >= 'A' && letter <= 'Z') {
      result += lower(letter);
    } else if (!result.empty() && result.back() != '-') {
      result += '-';
    }
  }
  while (!result.empty() && result.back() == '-') result.pop_back();
  return result.substr(0, most);
}

std::size_t text_width(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string to;
  while (true) {
    const std::size_t end = text.find('\n');
    append_wrapped(to, text.substr(0, end), width, indent);
    if (end == std::string_view::npos) return to;
    to += '\n';
    text.remove_prefix(end + 1);
  }
}

std::string shell_word(const std::string& text) {
  static constexpr std::string_view kPlain = "_./=,+-:@%";
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || kPlain.find(static_cast<char>(c)) != kPlain.npos;
  };
  if (!text.empty() && std::ranges::all_of(text, plain)) return text;
  std::string word = "'";
  for (const char letter : text) word += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return word + "'";
}

}  // namespace gust
