#include "gust/cli/toml_format.h"

#include <algorithm>
#include <vector>

#include "gust/core/error.h"
#include "gust/core/text.h"

namespace gust {
namespace {

constexpr std::string_view kBlanks = " \t";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

/// Where one of these letters stands outside of quotes and brackets; npos where none does.
std::size_t find_outside(std::string_view text, std::string_view letters) {
  char quote = 0;
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (quote != 0) {
      if (letter == '\\' && quote == '"') ++i;
      if (letter == quote) quote = 0;
      continue;
    }
    if (depth == 0 && letters.find(letter) != letters.npos) return i;
    if (letter == '"' || letter == '\'') quote = letter;
    if (letter == '{' || letter == '[') ++depth;
    if (letter == '}' || letter == ']') --depth;
  }
  return text.npos;
}

std::string comment_lines(std::string_view comment, std::size_t width) {
  const std::string lines = wrapped(trimmed(comment), width - std::min(width - 1, std::size_t{2}));
  std::string to = "# ";
  for (const char letter : lines) to += letter == '\n' ? std::string("\n# ") : std::string(1, letter);
  return to;
}

/// "text" as """\ … """ over several lines, whose ends are masked.
std::string string_lines(std::string_view key, std::string_view text, std::size_t width) {
  constexpr std::size_t kIndent = 4;
  std::string to = cat(key, " = \"\"\"\\\n", std::string(kIndent, ' '));
  const std::string lines = wrapped(text, width - std::min(width - 1, kIndent + 3));  // " \" or the closing quotes
  for (const char letter : lines) to += letter == '\n' ? " \\\n" + std::string(kIndent, ' ') : std::string(1, letter);
  return to + "\"\"\"";
}

void add_entry(std::string_view key, std::string_view value, std::size_t width, std::vector<std::string>& to) {
  const std::string line = cat(key, " = ", value);
  if (text_width(line) <= width) return to.push_back(line);
  if (value.starts_with('"') && value.ends_with('"') && value.find('\\') == value.npos)
    return to.push_back(string_lines(key, value.substr(1, value.size() - 2), width));
  if (!value.starts_with('{') || !value.ends_with('}')) return to.push_back(line);
  std::string_view rest = value.substr(1, value.size() - 2);
  while (!trimmed(rest).empty()) {
    const std::size_t end = std::min(find_outside(rest, ","), rest.size());
    const std::string_view item = rest.substr(0, end);
    const std::size_t sign = std::min(find_outside(item, "="), item.size() - 1);
    add_entry(cat(key, ".", trimmed(item.substr(0, sign))), trimmed(item.substr(sign + 1)), width, to);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
}

/// A line that is too long.
std::string broken(std::string_view line, std::size_t width) {
  const std::size_t hash = find_outside(line, "#");
  std::vector<std::string> lines;
  if (hash != line.npos) lines.push_back(comment_lines(line.substr(hash + 1), width));
  const std::string_view content = line.substr(0, hash);
  const std::string_view bare = content.substr(0, content.find_last_not_of(kBlanks) + 1);
  const std::size_t sign = find_outside(bare, "=");
  if (text_width(bare) <= width || sign == bare.npos) {
    if (!bare.empty()) lines.emplace_back(bare);
  } else {
    add_entry(trimmed(bare.substr(0, sign)), trimmed(bare.substr(sign + 1)), width, lines);
  }
  return join(lines, "\n");
}

}  // namespace

std::string wrapped_toml(std::string_view text, std::size_t width) {
  std::vector<std::string> lines;
  while (true) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    lines.push_back(text_width(line) <= width ? std::string(line) : broken(line, width));
    if (end == text.size()) return join(lines, "\n");
    text.remove_prefix(end + 1);
  }
}

}  // namespace gust
